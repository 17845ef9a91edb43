#!/usr/bin/env bash
# visual-kinematics 0.2.1 turns a joint back all round where it moves over 180 degrees, and a tool likewise on a straight line.
#
# A flat arm of two links and a wrist goes between two poses whose base angles are 170 and 190 degrees, and a tool turns from 170 to 190 degrees on a straight line. The guess: the
# way in between is the short one, over 180 degrees; in both cases 20 degrees, for the package states the angle between the frames as 20 degrees itself. What
# comes: as the second pose has the joint angle -170, the base turns 340 degrees the other way, and halfway the hand is on the other side of the robot; on the straight line
# the place is right and the tool turns 340 degrees, by its Euler angles, and halfway it points to the other side. From 100 to 120 degrees all is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check visual-kinematics==0.2.1 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
from visual_kinematics.Frame import Frame
from visual_kinematics.RobotSerial import RobotSerial
from visual_kinematics.RobotTrajectory import RobotTrajectory


def arm():
    return RobotSerial(np.array([[0.2, 0.3, 0.0, 0.0], [0.0, 0.2, 0.0, 0.0], [0.1, 0.0, 0.0, 0.0]]), step_size=0.5, max_iter=2000, final_loss=1e-6)


def pose(robot, base, elbow, wrist):
    return robot.forward(np.radians([base, elbow, wrist]))


def turned(motion, start, end):
    """How the joints come from one pose to the other in ten steps, and where the hand is halfway."""
    robot = arm()
    frames = [Frame(pose(robot, *joints).t_4_4.copy()) for joints in (start, end)]
    robot.forward(np.radians(start))
    angles = RobotTrajectory(robot, frames).interpolate(10, motion=motion)[0]
    way = np.unwrap(angles, axis=0) if motion == "lin" else angles
    moves = np.degrees(np.abs(np.diff(way, axis=0)).sum(axis=0))
    middle = robot.forward(angles[5])
    place, direction = middle.t_3_1.flatten(), np.degrees(middle.euler_3[0])
    apart = np.degrees(frames[0].angle_to(frames[1]))
    return f"{apart:.0f} degrees apart, joints turn {moves.round() + 0.0}, halfway at X {place[0]:+.3f} Y {place[1]:+.3f}, tool at {direction:.0f} degrees"


for first, last in ((100, 120), (170, 190)):
    print(f"p2p, base {first} to {last}:", turned("p2p", (first, 30.0, 0.0), (last, 30.0, 0.0)))
for first, last in ((100, 120), (170, 190)):
    print(f"lin, tool {first} to {last}:", turned("lin", (20.0, 60.0, first - 80.0), (20.0, 60.0, last - 80.0)))
PYTHON
cat >expected <<'TEXT'
p2p, base 100 to 120: 20 degrees apart, joints turn [20.  0.  0.], halfway at X -0.256 Y +0.410, tool at 140 degrees
p2p, base 170 to 190: 20 degrees apart, joints turn [340.   0.   0.], halfway at X +0.473 Y +0.100, tool at 30 degrees
lin, tool 100 to 120: 20 degrees apart, joints turn [ 0.  0. 20.], halfway at X +0.317 Y +0.300, tool at 110 degrees
lin, tool 170 to 190: 20 degrees apart, joints turn [  0.   0. 340.], halfway at X +0.317 Y +0.300, tool at 0 degrees
TEXT
MPLBACKEND=Agg MPLCONFIGDIR="$work" venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
