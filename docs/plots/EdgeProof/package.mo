within;
package EdgeProof "Axes whose motion is hard to follow in long steps"
  type Position = Real(unit = "m");
  type Velocity = Real(unit = "m/s");
  type Acceleration = Real(unit = "m/s2");
  type Time = Real(unit = "s");

  partial model Axis "What the bench needs of an axis"
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
  end Axis;

  model Bent "Mass whose acceleration steps at an instant"
    extends Axis;
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

  model Elastic "Drive with a motor and a load on a spring: 160 Hz with the motor held"
    extends Axis;
    parameter Real kv(unit = "1/s") = 40 "Position loop";
    parameter Real motor_mass(unit = "kg") = 71 "In terms of the load";
    parameter Real load_mass(unit = "kg") = 120 "Load";
    parameter Real stiffness(unit = "N/m") = 1.2127e8 "Screw";
    parameter Real damping(unit = "N.s/m") = 2e3 "Screw";
    parameter Real gain(unit = "N.s/m") = 7.2e4 "Velocity loop";
    parameter Time integral_time = 8e-3 "Velocity loop";
    parameter Real current_rate(unit = "1/s") = 5000 "Current loop";
  protected
    Position x(start = 0, fixed = true) "Load";
    Velocity v(start = 0, fixed = true) "Load";
    Position s(start = 0, fixed = true) "Motor";
    Velocity w(start = 0, fixed = true) "Motor";
    Real force(start = 0, fixed = true, unit = "N") "Of the motor";
    Real integral(start = 0, fixed = true, unit = "N") "Of the velocity loop";
    Real screw(unit = "N") "Force of the screw on the load";
    Boolean moving "The demand still moves";
    Velocity slope "Of the demand";
    Velocity error "Of the velocity loop";
  equation
    moving = time < reference_end;
    slope = if moving then reference_velocity else 0;
    demand_position = reference_position
      + reference_velocity*((if moving then time else reference_end) - reference_time);
    error = kv*(demand_position - s) + slope - w;
    der(integral) = gain*error/integral_time;
    der(force) = current_rate*(gain*error + integral - force);
    screw = stiffness*(s - x) + damping*(w - v);
    der(s) = w;
    motor_mass*der(w) = force - screw;
    der(x) = v;
    load_mass*der(v) = screw;
    position = x;
    velocity = v;
    motor_position = s;
    motor_velocity = w;
  end Elastic;
end EdgeProof;
