% Times of the estimators of GNU Octave's control package.
% usage: octave-cli peers.m DATA.csv TASK... ; prints one line a task: task, wall s, processor s, error.
1;

function h = impulse_response (sys)
  [a, b, c, ~] = ssdata (ss (sys));
  x = b(:, 1);
  h = zeros (100, 1);
  for t = 2:100
    h(t) = c * x;
    x = a * x;
  end
end

function e = response_error (sys)
  truth = filter ([0 1 0.5], [1 -1.5 0.7], [1; zeros(99, 1)]);
  e = norm (impulse_response (sys) - truth) / norm (truth);
end

function sys = order_scan (dat)
  % Its B starts at a delay of one sample, and nk counts further ones.
  for na = 1:10
    for nb = 1:10
      sys = arx (dat, 'na', na, 'nb', nb, 'nk', 0);
    end
  end
end

function [sys, wall, processor] = timed (f)
  id = tic ();
  before = cputime ();
  sys = f ();
  processor = cputime () - before;
  wall = toc (id);
end

pkg load control
options = argv ();
data = dlmread (options{1}, ',', 1, 0);
dat = iddata (data(:, 2), data(:, 1), 1);
for k = 2:numel (options)
  scan = false;
  switch options{k}
    case 'arx'
      f = @() arx (dat, 'na', 4, 'nb', 4, 'nk', 0);
    case 'n4sid'
      f = @() n4sid (dat, 4);
    case 'moen4'
      f = @() moen4 (dat, 4);
    case 'scan'
      f = @() order_scan (dat);
      scan = true;
  end
  try
    [sys, wall, processor] = timed (f);
    % One run to warm up, then the median of three; one alone where it takes long.
    if wall < 10
      repetitions = max (1, ceil (0.1 / wall));
      for i = 1:3
        id = tic ();
        before = cputime ();
        for j = 1:repetitions
          again = f ();
        end
        processors(i) = (cputime () - before) / repetitions;
        walls(i) = toc (id) / repetitions;
      end
      wall = median (walls);
      processor = median (processors);
    end
    e = NaN;
    if ! scan
      e = response_error (sys);
    end
    printf ("%s\t%.9g\t%.9g\t%.9g\n", options{k}, wall, processor, e);
  catch failure
    printf ("%s\tfailed: %s\n", options{k}, strtok (failure.message, "\n"));
  end
end
