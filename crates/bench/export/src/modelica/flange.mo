    Modelica.Blocks.Interfaces.RealOutput w_d(unit = "rad/s") "speed of the dynamometer"
      annotation (Placement(transformation(extent = {{-10, -10}, {10, 10}}, rotation = 270, origin = {-60, -70})));
    Modelica.Blocks.Interfaces.RealOutput T_d(unit = "N.m") "torque of the dynamometer"
      annotation (Placement(transformation(extent = {{-10, -10}, {10, 10}}, rotation = 270, origin = {-20, -70})));
    Modelica.Blocks.Interfaces.RealOutput T_shaft(unit = "N.m") "torque of the shaft"
      annotation (Placement(transformation(extent = {{-10, -10}, {10, 10}}, rotation = 270, origin = {20, -70})));
    Modelica.Blocks.Interfaces.BooleanOutput valid "speed and torque are within the range of the recordings"
      annotation (Placement(transformation(extent = {{-10, -10}, {10, 10}}, rotation = 270, origin = {60, -70})));
    Modelica.Mechanics.Rotational.Interfaces.Flange_a flange "flange of the engine, whose inertia J_e is in the plant"
      annotation (Placement(transformation(extent = {{90, -10}, {110, 10}})));
    Plant plant(w_start = w_start, T_start = T_start@OF_PLANT@);