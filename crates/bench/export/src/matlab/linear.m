function [discrete, continuous, model] = @NAME@ ()
% @UPPER@  Linear model. Written by dynoid @VERSION@.
%
%   [discrete, continuous, model] = @NAME@ () returns
%     discrete    ss on the clock of the data
%     continuous  ss in continuous time, in MATLAB with its delays; [] for a discrete model
%     model       matrices with the noise gain K, names, units, parameters and covariance
%   @NAME@ () without outputs draws the frequency response.
%
%   @LEVELS@
%   They are model.InputOffset and model.OutputOffset, where there are single ones.
%
%   It needs the Control System Toolbox, or Octave with its package control. With the System Identification Toolbox, idss (discrete)
%   gives a model for compare and resid.

  is_octave = exist ('OCTAVE_VERSION', 'builtin') ~= 0;
  if is_octave
    pkg ('load', 'control');
  end
  loaded = load (fullfile (fileparts (mfilename ('fullpath')), '@NAME@.mat'));
  model = loaded.model;
  discrete = system_of (model.discrete, model);
  continuous = [];
  if isfield (model, 'continuous')
    continuous = system_of (model.continuous, model);
    if any (model.continuous.IODelay(:) > 0) && ~is_octave
      continuous.IODelay = model.continuous.IODelay;
    end
  end
  if nargout == 0
    bode (discrete);
    clear discrete continuous model
  end
end

function system = system_of (from, model)
  system = ss (from.A, from.B, from.C, from.D, from.Ts, 'inputname', model.InputName, 'outputname', model.OutputName);
end
