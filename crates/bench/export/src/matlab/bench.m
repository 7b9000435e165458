function [tn, nt, plant, bench] = @NAME@ ()
% @UPPER@  Bench model "@BENCH@". @WRITTEN@
%
%   [tn, nt, plant, bench] = @NAME@ () returns
%     tn     the bench in torque control, discrete: T_d_demand, T_e to w_d, w_e, T_d, T_shaft, T_d_demand
%     nt     the bench in speed control, discrete: w_d_demand, T_e to the same; [] without a speed controller. Recordings
%            have w_d_demand later by bench.demand_lead ticks: advance a recorded demand by as many
%     plant  mechanics and lag of the torque control, continuous; in MATLAB with the delay of T_d_demand
%     bench  parameters, units, covariance of independent parts, range of validity, and the matrices
%   @NAME@ () without outputs draws frequency and step responses.
%
%   All is in SI: rad/s, Nm, s. T_d is positive when it brakes the dynamometer. The discrete systems are exact for a demand that is
%   held and an engine torque that is linear between ticks, as long as the torque demand is below its limit. They need the Control
%   System Toolbox, or Octave with its package control. With the System Identification Toolbox, idss (tn) and idss (nt) give
%   models for compare and resid.

  is_octave = exist ('OCTAVE_VERSION', 'builtin') ~= 0;
  if is_octave
    pkg ('load', 'control');
  end
  loaded = load (fullfile (fileparts (mfilename ('fullpath')), '@NAME@.mat'));
  bench = loaded.bench;
  plant = system_of (bench.plant);
  if any (bench.plant.InputDelay > 0) && ~is_octave
    plant.InputDelay = bench.plant.InputDelay(:);
  end
  tn = [];
  nt = [];
  if isfield (bench, 'tn')
    tn = system_of (bench.tn);
  end
  if isfield (bench, 'nt')
    nt = system_of (bench.nt);
  end
  if nargout == 0
    draw (tn, nt, plant, bench);
    clear tn nt plant bench
  end
end

function system = system_of (from)
  system = ss (from.A, from.B, from.C, from.D, from.Ts, 'inputname', from.InputName, 'outputname', from.OutputName, ...
               'statename', from.StateName);
end

function draw (tn, nt, plant, bench)
  figure ('Name', [bench.name ': torque demand to shaft torque']);
  if isempty (tn)
    bode (plant(4, 1));
  else
    bode (tn(4, 1));
  end
  title ('T_d* to T_{shaft} in torque control');
  if ~isempty (nt)
    figure ('Name', [bench.name ': step of the speed demand']);
    step (nt(1, 1), 3);
    title ('w_d* to w_d in speed control');
  end
end
