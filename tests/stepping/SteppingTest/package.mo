within;
package SteppingTest "Axes and probes that a rig may meet"
  type Position = Real(unit = "m");
  type Velocity = Real(unit = "m/s");
  type Time = Real(unit = "s");

  model Bouncer "Probe whose contact closes three times, and then rests"
    input Time step_time;
    input Time step_size(start = 1);
    input Position z_start;
    input Velocity z_rate_start;
    input Position z_end;
    input Velocity z_rate_end;
    parameter Position surface = 0;
    parameter Time bounce = 8e-6 "How long it is closed or open";
    output Boolean signal;
    output Integer rising_count(start = 0, fixed = true);
    output Integer falling_count(start = 0, fixed = true);
    output Time rising_time(start = 0, fixed = true);
    output Time falling_time(start = 0, fixed = true);
  protected
    Boolean touched;
    Time touch(start = 1e60, fixed = true);
    Real u(unit = "1") "Share of the step that has passed";
    Position z;
  equation
    u = (time - step_time)/step_size;
    z = z_start + u*(step_size*z_rate_start
      + u*((3*(z_end - z_start) - step_size*(2*z_rate_start + z_rate_end))
      + u*(2*(z_start - z_end) + step_size*(z_rate_start + z_rate_end))));
    touched = z <= surface;
    when touched then
      touch = time;
    end when;
    signal = touched
      and not (time >= touch + bounce and time < touch + 2*bounce)
      and not (time >= touch + 3*bounce and time < touch + 4*bounce);
    when signal then
      rising_count = pre(rising_count) + 1;
      rising_time = time;
    end when;
    when not signal then
      falling_count = pre(falling_count) + 1;
      falling_time = time;
    end when;
  end Bouncer;

  model Jumper "Load that moves at once"
    input Position demand "Without effect";
    parameter Time jump_time = 0.0205;
    parameter Velocity speed = -5;
    output Position position;
    output Velocity velocity;
  protected
    Position x(start = 0, fixed = true);
  equation
    velocity = if time < jump_time then 0 else speed;
    der(x) = velocity;
    position = x;
  end Jumper;

  model Follower "Load that follows a plain demand with a lag"
    input Position demand;
    parameter Time lag = 5e-3;
    parameter Position position_start = 0;
    output Position position;
  protected
    Position x(start = position_start, fixed = true);
  equation
    der(x) = (demand - x)/lag;
    position = x;
  end Follower;

  model LevelProbe "Tells a level for a position"
    input Position z_position;
    parameter Position surface = 0;
    output Boolean signal;
  equation
    signal = z_position <= surface;
  end LevelProbe;

  model LateLevelProbe "Tells it later"
    input Position z_position;
    parameter Position surface = 0;
    parameter Time delay = 130e-6;
    output Boolean signal(start = false, fixed = true);
  protected
    Boolean touched;
    Time due(start = 1e60, fixed = true);
  equation
    touched = z_position <= surface;
    when touched then
      due = time + delay;
    end when;
    signal = time >= due;
  end LateLevelProbe;

  model LateOnLevelProbe "Tells it later, and at once that it is over"
    input Position z_position;
    parameter Position surface = 0;
    parameter Time delay = 130e-6;
    output Boolean signal(start = false, fixed = true);
  protected
    Boolean touched;
    Time due(start = 1e60, fixed = true);
  equation
    touched = z_position <= surface;
    when touched then
      due = time + delay;
    end when;
    signal = touched and time >= due;
  end LateOnLevelProbe;
end SteppingTest;
