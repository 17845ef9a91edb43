within;
package EdgeProof "An axis whose motion is hard to follow in long steps"
  type Position = Real(unit = "m");
  type Velocity = Real(unit = "m/s");
  type Acceleration = Real(unit = "m/s2");
  type Time = Real(unit = "s");

  model Bent "Mass whose acceleration steps at an instant"
    input Position reference_position "Demand at reference_time";
    input Velocity reference_velocity "Slope of the demand until reference_end";
    input Time reference_time "Instant of reference_position";
    input Time reference_end "Instant from which the demand rests";
    input Boolean enabled(start = false) "Without effect: always on";
    output Position position "Load";
    output Velocity velocity "Load";
    output Position motor_position "Encoder";
    output Velocity motor_velocity "Encoder";
    output Position demand_position "Demand";
    parameter Position position_start = 0 "Where it starts";
    parameter Velocity velocity_start = -0.02 "How fast it starts";
    parameter Acceleration acceleration_first = 0 "Until bend_time";
    parameter Acceleration acceleration_then = 1 "From bend_time on";
    parameter Time bend_time = 0.0234567 "Instant of the step";
  protected
    Position x(start = position_start, fixed = true);
    Velocity v(start = velocity_start, fixed = true);
  equation
    der(x) = v;
    der(v) = if time < bend_time then acceleration_first else acceleration_then;
    position = x;
    velocity = v;
    motor_position = x;
    motor_velocity = v;
    demand_position = reference_position;
  end Bent;
end EdgeProof;
