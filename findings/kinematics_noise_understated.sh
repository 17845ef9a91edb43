#!/usr/bin/env bash
# robotkinecal 0.1.0 finds a robot better calibrated than it is: readings with a noise of 0.1 mm are taken for 0.041 mm, and a smaller step is not taken.
#
# A robot of three joints and a tool has lengths that are wrong by 3 mm; a tracker reads the point of its tool with a noise of 0.1 mm. The guess: from places alone the residuals give the
# noise back (three numbers a reading and 15 parameters leave 3 N - 15 degrees of freedom, by which the sum of squares is divided), the step size scales each correction, and
# the history has the axes of each iteration; the package describes all three. What comes: it divides by 6 N - 15, as if each reading had an orientation too, and so the noise
# is 0.041 mm from 6 readings and 0.067 mm from 20, and each joint is as much more certain. A step of 0.1 gives the very errors of a whole step. And the first iteration
# of the history has the axes of the last one.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check robotkinecal==0.1.0 roboticstoolbox-python==1.4.4 spatialmath-python==1.1.18 numpy==1.26.4 scipy==1.17.1
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
from roboticstoolbox import ET, Link, Robot
from robotkinecal import SerialRobotKineCal

NOISE = 0.1e-3


def arm(error):
    """A robot whose lengths are wrong by an error in m."""
    first = Link(ET.tz(0.4 + error) * ET.Rz(), name="first")
    second = Link(ET.tx(0.05) * ET.Rx(-np.pi / 2) * ET.Rz(), name="second", parent=first)
    third = Link(ET.tx(0.5 + error) * ET.ty(-error) * ET.Rz(), name="third", parent=second)
    return SerialRobotKineCal(Robot([first, second, third, Link(ET.tx(0.4) * ET.ty(0.1) * ET.tz(0.05), name="tool", parent=third)]), "tool")


def calibrated(count, seed, **how):
    np.random.seed(seed)
    joints = [np.random.uniform(-1.5, 1.5, 3) for _ in range(count)]
    robot = arm(0.0)
    robot.set_observations(joints, [real.forward_kinematics(4, place).t + np.random.normal(0, NOISE, 3) for place in joints])
    return robot.solve(**how)


def noise(result):
    """The noise of a reading in mm, by the stated uncertainty of a joint, and by the degrees of freedom."""
    last = result.iteration_results[-1]
    stated = last.get_statistics()["joints_uncertainty"][0] / np.linalg.norm(np.diag(np.linalg.inv(last.A_all.T @ last.A_all))[:4])
    rest = last.twist_errors - last.A_all @ last.twist_corrections
    return stated, (rest**2).sum() / (3 * last.N_OBSERVATIONS - np.linalg.matrix_rank(last.A_all))


real = arm(0.003)
for count in (6, 20):
    stated, freedom = np.mean([noise(calibrated(count, seed)) for seed in range(50)], axis=0)
    print(f"{count} readings with 0.100 mm of noise, mean of 50: stated {1e3 * stated**0.5:.3f} mm, by the degrees of freedom {1e3 * freedom**0.5:.3f} mm")
for step in (1.0, 0.1):
    errors = [1e3 * max(one.position_errors) for one in calibrated(20, 5, step_size=step).iteration_results]
    print(f"step {step}: largest errors before each correction", *(f"{error:.2f}" for error in errors), "mm")
first = [calibrated(20, 5, max_iterations=most).iteration_results[0].joint_screw_definitions[0][0] for most in (1, 2)]
print("first axis after the first iteration, if that is the only one, and if there are two:", *(f"{1e6 * place:.2f}" for place in first), "um")
PYTHON
cat >expected <<'TEXT'
6 readings with 0.100 mm of noise, mean of 50: stated 0.041 mm, by the degrees of freedom 0.108 mm
20 readings with 0.100 mm of noise, mean of 50: stated 0.067 mm, by the degrees of freedom 0.102 mm
step 1.0: largest errors before each correction 7.39 0.27 0.27 mm
step 0.1: largest errors before each correction 7.39 0.27 0.27 mm
first axis after the first iteration, if that is the only one, and if there are two: -14.40 -14.44 um
TEXT
MPLBACKEND=Agg MPLCONFIGDIR="$work" venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
