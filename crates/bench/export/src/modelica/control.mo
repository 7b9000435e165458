
  model SpeedController "PI with feed-forward, as it runs: every T_s, its output held"
@CONTROLLER_PARAMETERS@    parameter Real w_start(unit = "rad/s") = @W_START@ "speed at the start";
    parameter Real T_start(unit = "N.m") = @T_START@ "torque at the start";
@AHEAD_OF_CONTROLLER@    input Real w_d_demand(unit = "rad/s", start = w_start) "speed demand@DEMAND_LEAD@";
    input Real w_d(unit = "rad/s", start = w_start) "speed as the encoder reads it";
    output Real T_d_demand(unit = "N.m") "demanded torque@LATE@";
  protected
    discrete Real integrator(unit = "N.m", start = T_start - @FEED_START@, fixed = true);
    discrete Real error(unit = "rad/s", start = 0.0, fixed = true);
    discrete Real pi_part(unit = "N.m", start = T_start - @FEED_START@, fixed = true) "output of PI before its delay";
    discrete Real feed_forward(unit = "N.m", start = @FEED_START@, fixed = true);
@PAST@  equation
    when sample(0.0, T_s) then
      past_0 = w_d_demand;
@PAST_EQUATIONS@      error = @READING_IN_ERROR@ - past_@LAG@;
      pi_part = K_p * error + pre(integrator);
      feed_forward = @FEED@;
@FED_EQUATIONS@      integrator = @INTEGRATOR@;
    end when;
    T_d_demand = @LIMITED@;
@ICON@  end SpeedController;

  model SpeedControl "The bench in speed control (NT)"
    parameter Real w_start(unit = "rad/s") = @W_START@ "speed at the start";
    parameter Real T_start(unit = "N.m") = @T_START@ "torque at the start";
    input Real w_d_demand(unit = "rad/s", start = w_start) "speed demand@DEMAND_LEAD@";
    input Real T_e(unit = "N.m", start = T_start) "torque of the engine";
    output Real w_d(unit = "rad/s") "speed of the dynamometer";
    output Real w_e(unit = "rad/s") "speed of the engine";
    output Real T_d(unit = "N.m") "torque of the dynamometer";
    output Real T_shaft(unit = "N.m") "torque of the shaft";
    output Boolean valid "speed and torque are within the range of the recordings";
    Plant plant(w_start = w_start, T_start = T_start@OF_PLANT@);
    SpeedController controller(w_start = w_start, T_start = T_start);
  equation
    controller.w_d_demand = w_d_demand;
    controller.w_d = plant.w_d_read;
    plant.T_d_demand = controller.T_d_demand;
    plant.T_e = T_e;
    w_d = plant.w_d;
    w_e = plant.w_e;
    T_d = plant.T_d;
    T_shaft = plant.T_shaft;
    valid = plant.valid;
@ICON@  end SpeedControl;

  model SpeedControlFlange "SpeedControl with the flange of the engine, for Modelica.Mechanics.Rotational"
    parameter Real w_start(unit = "rad/s") = @W_START@ "speed at the start";
    parameter Real T_start(unit = "N.m") = @T_START@ "torque at the start";
    Modelica.Blocks.Interfaces.RealInput w_d_demand(unit = "rad/s", start = w_start) "speed demand@DEMAND_LEAD@"
      annotation (Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
@FLANGE@
    SpeedController controller(w_start = w_start, T_start = T_start);
  equation
    controller.w_d_demand = w_d_demand;
    controller.w_d = plant.w_d_read;
    plant.T_d_demand = controller.T_d_demand;
@FLANGE_EQUATIONS@
@ICON@  end SpeedControlFlange;
