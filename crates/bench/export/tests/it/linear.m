% Simulates an exported linear model and compares it with the program.
arguments = argv ();
folder = arguments{end};
addpath (folder);
[discrete, continuous, model] = arx ();
u = dlmread (fullfile (folder, 'u.csv'));
expected = dlmread (fullfile (folder, 'y.csv'));
y = lsim (discrete, u, (0:rows (u) - 1)' * get (discrete, 'tsam'));
printf ('y %g\n', max (abs (y - expected)) / max (abs (expected)));
