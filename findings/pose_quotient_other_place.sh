#!/usr/bin/env bash
# dual-quaternions 0.4.0 divides two poses to one that is none, and loses the displacement between logarithm and exponential.
#
# The tool of a robot is at A, turned by 90 degrees about z, the part at B, turned by 90 degrees about x. The guess: A / B is A times the inverse of B, so that (A / B) times B is A
# again; and exp(log(A)) is A, as each logarithm of a rigid motion leads back to it (Selig, Geometric Fundamentals of Robotics).
# What comes: the rotation of the quotient is right, its displacement is another one, for the dual parts are multiplied in the wrong order; it is not
# normalised and (A / B) B is elsewhere. Two turns about one axis alike. The exponential of the logarithm keeps the rotation and moves the tool; of a displacement
# without rotation it makes the identity. The inverse, the powers and the interpolation between two poses are right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check dual-quaternions==0.4.0 pyquaternion==0.9.9 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
from dual_quaternions import DualQuaternion


def pose(axis, degrees, place):
    half = np.radians(degrees) / 2
    return DualQuaternion.from_quat_pose_array([np.cos(half), *(np.sin(half) * np.array(axis)), *place])


def show(name, it):
    place = " ".join(f"{value:.1f}" for value in np.array(it.translation()) + 1e-9)
    print(f"{name}: at {place} mm, turned by {abs(it.q_r.degrees):.1f} degrees, a rigid motion: {bool(it.is_normalized)}")


tool, part = pose([0, 0, 1], 90, [100, 0, 0]), pose([1, 0, 0], 90, [0, 50, 20])
show("tool A", tool)
show("A times inverse of B", tool * part.inverse())
show("A / B", tool / part)
show("(A / B) B", (tool / part) * part)
first, second = pose([0, 0, 1], 30, [100, 0, 0]), pose([0, 0, 1], 60, [0, 50, 20])
show("about one axis, A times inverse of B", first * second.inverse())
show("about one axis, A / B", first / second)
show("half of A twice", tool.pow(0.5) * tool.pow(0.5))
show("exp(log(A))", tool.log().exp())
slide = pose([0, 0, 1], 0, [5, 6, 7])
show("slide", slide)
show("half of the slide twice", slide.pow(0.5) * slide.pow(0.5))
show("exp(log(slide))", slide.log().exp())
PYTHON
cat >expected <<'TEXT'
tool A: at 100.0 0.0 0.0 mm, turned by 90.0 degrees, a rigid motion: True
A times inverse of B: at 120.0 0.0 50.0 mm, turned by 120.0 degrees, a rigid motion: True
A / B: at 100.0 50.0 -70.0 mm, turned by 120.0 degrees, a rigid motion: False
(A / B) B: at 80.0 50.0 -120.0 mm, turned by 90.0 degrees, a rigid motion: False
about one axis, A times inverse of B: at 75.0 -43.3 -20.0 mm, turned by 30.0 degrees, a rigid motion: True
about one axis, A / B: at 75.0 43.3 -20.0 mm, turned by 30.0 degrees, a rigid motion: True
half of A twice: at 100.0 0.0 0.0 mm, turned by 90.0 degrees, a rigid motion: True
exp(log(A)): at 50.0 50.0 0.0 mm, turned by 90.0 degrees, a rigid motion: True
slide: at 5.0 6.0 7.0 mm, turned by 0.0 degrees, a rigid motion: True
half of the slide twice: at 5.0 6.0 7.0 mm, turned by 0.0 degrees, a rigid motion: True
exp(log(slide)): at 0.0 0.0 0.0 mm, turned by 0.0 degrees, a rigid motion: True
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
