within AxisRig;
package UsersGuide "How the library is meant"
  class Concept "What a plant is made of"
    annotation(DocumentationClass = true, Documentation(info="<html>
<p>An axis is one model: drive with its loops, motor, mechanics and a fixed stop (package Drives, from parts
of Mechanics). What is stiff stays in one model. A sensor reads positions and never acts back on the
machine (package Sensors); what it looks at is a surface (package Workpieces). Where a sensor is at an inclined
tool, it has the kinematic of its machine in it (package Kinematics).</p>
<p>A demand comes from a numerical control over a fieldbus. Between two telegrams it is straight in time:
position, velocity, the instant at which they hold and the instant from which the demand rests
(Drives.Setpoint).</p>
<p>A sensor in an FMU of its own is stepped after the axes over the same communication step. It gets
the motion of the step as position and rate at both ends (Sensors.MovingSensor), so that an edge has its
instant within the step. A master that cannot give this takes Machines.ProbeOnAxis or
Machines.DistanceSensorOnAxis: axis and sensor in one model, joined inside.</p>
<p>Edges are never lost between two steps: a sensor gives its level, the instant of its last rising and
falling edge, and how many there were.</p>
</html>"));
  end Concept;

  class Conventions "Units, signs, names"
    annotation(DocumentationClass = true, Documentation(info="<html>
<p>Units: SI. Every variable has a type of package Units, or a unit beside it. Angles are in rad.</p>
<p>Signs: a force at a flange acts into the component. Forces of stops are amounts, never negative. Up is
positive for a vertical axis. Heights of workpieces count along z, upwards.</p>
<p>Names: what ends in <code>_start</code> belongs to the beginning (of a run for a parameter, of a
communication step for an input), <code>_time</code> is an instant or a duration in s, <code>_count</code> a
number since the start. A truth (<code>position</code>, <code>contact_time</code>) is for observers, not for the
control.</p>
<p>Signals: inputs and outputs are connectors of package Interfaces. <code>connect</code> joins Real ones that
are passed on as they are. Expressions, levels and whole numbers are given by equations, which is equal in
the language: the compiler that makes the FMUs (rumoca 0.10.2) refuses <code>connect</code> for levels and
whole numbers.</p>
<p>Events: what changes at an instant is a relation or a when-clause; no component samples unless its name
says so. Random numbers repeat with a seed.</p>
<p>Each class says equation, assumption, limit and source.</p>
</html>"));
  end Conventions;

  class Contact "Where to ask and report"
    annotation(DocumentationClass = true, Documentation(info="<html>
<p>The library is a part of the project axisrig. Questions and mistakes go to the issues of that project,
with the version of the library, the tool and its version, and the model.</p>
<p>Licence: Apache-2.0, in the file LICENSE of the project.</p>
</html>"));
  end Contact;

  class ReleaseNotes "What has changed"
    annotation(DocumentationClass = true, Documentation(info="<html>
<h4>0.2.0, 2026-11-29</h4>
<ul>
<li>New: Drives.TiltingSlide, a slide and a tilting axis that share the force of a fixed stop at the tool.</li>
<li>Sensors.WorkpieceProbe: <code>contact_modulus</code>, by which ball and surface yield where they touch
(Hertz); off by default. Scatter of its pre-travel, a first touch that is off, and a drift.</li>
<li>New: a touch probe at a head with C and A axes.</li>
</ul>
<h4>0.1.0, 2026-11-25</h4>
<ul>
<li>First version with a version number.</li>
<li>Inputs and outputs are connectors (package Interfaces); no input of a component waits for an
equation. Icons and diagrams; parameters in groups.</li>
<li>Constants has the only pi. Renamed, since the old names are operators of the language:
<code>Workpiece.edge</code> is <code>border</code>, <code>EdgeDelay.delay</code> is <code>dead_time</code>,
<code>SwitchOnDelay.delay</code> is <code>start_up_time</code>.</li>
<li>New: Machines.ProbeOnAxis and Machines.DistanceSensorOnAxis; Examples Touch, FixedStop, DistanceLoop, Homing
and Gantry with reference results.</li>
<li>New: package Kinematics (HeadCA, SixJointRobot, ToolExtension), Sensors.HeadDistanceSensor and
Sensors.RobotDistanceSensor at an inclined tool.</li>
</ul>
</html>"));
  end ReleaseNotes;
  annotation(
    DocumentationClass = true,
    Documentation(info="<html>
<p>Concept, conventions, contact and release notes of the library.</p>
</html>"));
end UsersGuide;
