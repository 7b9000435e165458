% One task of commands.py with Octave and its control package: commands_peer.m TASK FILE
words = argv ();
task = words{1};
file = words{2};
data = dlmread (file, ",", 1, 0);
if strcmp (task, "arx")
  [u, y] = deal (data(:, 2), data(:, 5));
  n = numel (y);
  rows = [-y(4:n-1), -y(3:n-2), -y(2:n-3), -y(1:n-4), u(4:n-1), u(3:n-2), u(2:n-3), u(1:n-4)];
  found = rows \ y(5:n);
  printf ("[%.12g, %.12g, %.12g, %.12g, %.12g, %.12g, %.12g, %.12g]\n", found);
elseif strcmp (task, "n4sid")
  pkg load control
  found = n4sid (iddata (data(:, [5 6]), data(:, [2 3]), 1e-3), 10);
  printf ("[%.12g]\n", size (found.a, 1));
end
