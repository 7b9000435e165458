% Simulates the systems of an exported function and compares them with the program.
arguments = argv ();
folder = arguments{end};
addpath (folder);
[tn, nt, plant, bench] = test_cell_4 ();
assert (bench.parameters.K, 2437.7);
assert (size (plant), [4, 2]);
systems = struct ('nt', {{nt}}, 'tn', {{tn}});
for mode = {'nt', 'tn'}
  system = systems.(mode{1}){1};
  u = dlmread (fullfile (folder, [mode{1}, '_u.csv']), ',');
  expected = dlmread (fullfile (folder, [mode{1}, '_y.csv']), ',');
  t = (0:rows (u) - 1)' * get (system, 'tsam');
  y = lsim (system, u, t);
  names = get (system, 'outname');
  for i = 1:columns (y)
    printf ('%s %s %g\n', mode{1}, names{i}, max (abs (y(:, i) - expected(:, i))) / max (abs (expected(:, i))));
  end
end
