within ;
package @CLASS@ "@TITLE@"

  model Plant "Two masses and a shaft@WITH_TORQUE_CONTROL@"
@PLANT_PARAMETERS@    parameter Real w_start(unit = "rad/s") = @W_START@ "speed at the start";
    parameter Real T_start(unit = "N.m") = @T_START@ "torque at the start";
    input Real @TORQUE@(unit = "N.m", start = T_start) "@TORQUE_WORDS@; positive brakes the dynamometer";
    input Real T_e(unit = "N.m", start = T_start) "torque of the engine";
    output Real w_d(unit = "rad/s", start = w_start, fixed = true) "speed of the dynamometer";
    output Real w_e(unit = "rad/s", start = w_start, fixed = true) "speed of the engine";
    output Real T_shaft(unit = "N.m") "torque of the shaft";
@TORQUE_OUTPUT@    output Real w_d_read(unit = "rad/s") "w_d as its encoder reads it";
    output Boolean valid "speed and torque are within the range of the recordings";
  protected
    Real twist(unit = "rad", start = T_start / K, fixed = true) "twist of the shaft";
    Real turn(unit = "rad", start = 0.0, fixed = true) "angle of the dynamometer beyond that of w_start";
  equation
    J_d * der(w_d) = T_shaft - T_d;
    J_e * der(w_e) = T_e - T_shaft;
    der(twist) = w_e - w_d;
    T_shaft = K * twist + B * (w_e - w_d);
@TORQUE_EQUATION@    der(turn) = w_d - w_start;
    w_d_read = @READING@;
    valid = @VALID@;
  end Plant;
@CONTROL@
  annotation (Documentation(info = "<html>
@DOCUMENTATION@
</html>"));
end @CLASS@;
