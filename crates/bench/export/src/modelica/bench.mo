within ;
package @CLASS@ "@TITLE@"

  model Plant "Two masses and a shaft@WITH_TORQUE_CONTROL@"
@PLANT_PARAMETERS@    parameter Real w_start(unit = "rad/s") = @W_START@ "speed at the start";
    parameter Real T_start(unit = "N.m") = @T_START@ "torque at the start";
    parameter Real friction_coulomb(unit = "N.m") = 0.0 "friction of the dynamometer, beside T_d, whatever its speed";
    parameter Real friction_viscous(unit = "N.m.s/rad") = 0.0 "the same per speed";
    parameter Real ripple_torque(unit = "N.m") = 0.0 "amplitude of the drive's ripple, beside T_d, whatever T_d is";
    parameter Real ripple_part(unit = "1") = 0.0 "the same per T_d";
    parameter Real ripple_order(unit = "1") = 1.0 "periods of the ripple in a turn of the dynamometer";
@AHEAD_OF_PLANT@    input Real @TORQUE@(unit = "N.m", start = T_start) "@TORQUE_WORDS@; positive brakes the dynamometer";
    input Real T_e(unit = "N.m", start = T_start) "torque of the engine";
    output Real w_d(unit = "rad/s", start = w_start, fixed = true) "speed of the dynamometer";
    output Real w_e(unit = "rad/s", start = w_start, fixed = true) "speed of the engine";
    output Real T_shaft(unit = "N.m") "torque of the shaft";
@TORQUE_OUTPUT@    output Real w_d_read(unit = "rad/s") "w_d as its encoder reads it";
    output Boolean valid "speed and torque are within the range of the recordings";
    Real T_friction(unit = "N.m") "friction of the dynamometer";
    Real T_ripple(unit = "N.m") "ripple of the drive";
  protected
    Real twist(unit = "rad", start = T_start / K, fixed = true) "twist of the shaft";
    Real turn(unit = "rad", start = 0.0, fixed = true) "angle of the dynamometer beyond that of w_start";
  equation
    J_d * der(w_d) = T_shaft - T_d - T_friction - T_ripple;
    J_e * der(w_e) = T_e - T_shaft;
    der(twist) = w_e - w_d;
    T_shaft = K * twist + B * (w_e - w_d);
@TORQUE_EQUATION@    // Within 0.5 rad/s of standstill, Coulomb friction is proportional to the speed.
    T_friction = friction_coulomb * max(-1.0, min(1.0, w_d / 0.5)) + friction_viscous * w_d;
    T_ripple = (ripple_torque + ripple_part * T_d) * sin(ripple_order * (turn + w_start * time));
    der(turn) = w_d - w_start;
    w_d_read = @READING@;
    valid = @VALID@;
@ICON@  end Plant;

  model PlantFlange "Plant with the flange of the engine, for Modelica.Mechanics.Rotational"
    parameter Real w_start(unit = "rad/s") = @W_START@ "speed at the start";
    parameter Real T_start(unit = "N.m") = @T_START@ "torque at the start";
    Modelica.Blocks.Interfaces.RealInput @TORQUE@(unit = "N.m", start = T_start) "@TORQUE_WORDS@; positive brakes the dynamometer"
      annotation (Placement(transformation(extent = {{-120, -10}, {-100, 10}})));
@FLANGE@
  equation
    plant.@TORQUE@ = @TORQUE@;
@FLANGE_EQUATIONS@
@ICON@  end PlantFlange;
@CONTROL@
  annotation (Documentation(info = "<html>
@DOCUMENTATION@
</html>"));
end @CLASS@;
