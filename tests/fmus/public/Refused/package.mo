package Refused "Constructs that no FMU of this exporter can hold"
  model StringParameter
    parameter String name = "motor";
    output Real y;
  equation
    y = time;
  end StringParameter;

  function external_sine
    input Real x;
    output Real y;
    external "C" y = sin(x);
  end external_sine;

  model ExternalFunction
    output Real y;
  equation
    y = external_sine(time);
  end ExternalFunction;

  model TooManyEquations
    output Real y;
  equation
    y = time;
    y = 2*time;
  end TooManyEquations;

  model TooFewEquations
    output Real y;
    Real z;
  equation
    y = time;
  end TooFewEquations;

  model UnknownFunction
    output Real y;
  equation
    y = bessel(time);
  end UnknownFunction;

  model WrongType
    output Real y;
    Boolean b;
  equation
    b = time > 1;
    y = b + 1;
  end WrongType;

  model RealEquality
    output Boolean b;
  equation
    b = sin(time) == 0.5;
  end RealEquality;

  model DerOfDiscrete
    discrete Real d(start = 0);
    output Real y;
  equation
    when time > 1 then
      d = 1;
    end when;
    y = der(d);
  end DerOfDiscrete;

  model VariableDelay
    output Real y;
  equation
    y = delay(sin(time), 0.1 + 0.05*sin(time), 0.2);
  end VariableDelay;

  model Spatial
    output Real a, b;
  equation
    (a, b) = spatialDistribution(sin(time), 0, time, true, {0.0, 1.0}, {0.0, 0.0});
  end Spatial;

  model Part
    parameter Real k = 2;
    output Real y = k*time;
  end Part;

  model Whole
    replaceable model Inner = Part;
    Inner inner_part;
    output Real y = inner_part.y;
  end Whole;

  model RedeclaredModifier "The compiler ignores k = 5"
    extends Whole(redeclare model Inner = Part(k = 5));
  end RedeclaredModifier;

  model ConstrainingModifier "The compiler ignores k = 6"
    replaceable model Inner = Part constrainedby Part(k = 6);
    Inner inner_part;
    output Real y = inner_part.y;
  end ConstrainingModifier;

  model Other
    parameter Real k = 7;
    output Real y = k*time*time;
  end Other;

  model Socket
    replaceable Part inner_part;
  end Socket;

  model Holder
    Socket whole;
  end Holder;

  model Heir
    extends Socket;
  end Heir;

  model NestedRedeclare "The compiler leaves whole.inner_part a Part"
    Holder holder(whole(redeclare Other inner_part));
    output Real y = holder.whole.inner_part.y;
  end NestedRedeclare;

  model InheritedRedeclare "The compiler leaves inner_part a Part"
    extends Heir(redeclare Other inner_part);
    output Real y = inner_part.y;
  end InheritedRedeclare;

  model BooleanArray "The compiler drops the equation of the array"
    Boolean b[2];
    output Integer n;
  equation
    b = {time > 0.2, time > 0.8};
    n = (if b[1] then 1 else 0) + (if b[2] then 1 else 0);
  end BooleanArray;

  model IntegerArray "The same in a loop"
    Integer k[2];
    output Integer n;
  equation
    for i in 1:2 loop
      k[i] = if time > 0.3*i then 1 else 0;
    end for;
    n = k[1] + k[2];
  end IntegerArray;

  model ClockedSynchronous
    Clock c = Clock(0.1);
    Real x(start = 0);
    output Real y;
  equation
    x = sample(time, c) + previous(x);
    y = hold(x);
  end ClockedSynchronous;
end Refused;
