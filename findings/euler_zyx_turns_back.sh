#!/usr/bin/env bash
# poekit 0.1.0 turns the wrong way by ZYX angles, and finds joint angles for a point that cannot be reached.
#
# A tool is turned by 30 degrees about Z, and by three angles at once. The guess: the matrix of ZYX angles is Rz Ry Rx, as those of XYZ and ZYZ are Rx Ry Rz and Rz Ry Rz, and
# it undoes `quat_to_eulZYX` of the same package (intrinsic angles; the package names MATLAB's functions). What comes: the transpose, that is the turn back, and for the
# default sequence only. The axis of half a turn is (0, 0, 0), where one of 90 degrees is right. The second subproblem of Paden and Kahan, two turns about crossing axes, is told
# to give zeros where there is no solution: a point at twice the distance, where no turn leads, has the angles of the point at the right distance.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check poekit==0.1.0 numpy==2.4.6 sympy==1.14.0
cd "$work"
cat >try.py <<'PYTHON'
import numpy as np
from poekit.expmapping import ExpMapping
from poekit.paden_kahan import PadenKahan
from poekit.rotation_utils import RotationUtils

ABOUT = {"X": RotationUtils.rotX_to_tform, "Y": RotationUtils.rotY_to_tform, "Z": RotationUtils.rotZ_to_tform}
ANGLES = np.array([0.5, 0.2, -0.3])


def turn(sequence, angles):
    matrix = np.eye(3)
    for axis, angle in zip(sequence, angles):
        matrix = matrix @ ABOUT[axis](angle)[:3, :3]
    return matrix


for sequence in ("XYZ", "ZYZ", "ZYX"):
    made, wanted = RotationUtils.eul_2_rotm(ANGLES, sequence), turn(sequence, ANGLES)
    print(sequence, "is the product:", np.allclose(made, wanted), "is its transpose:", np.allclose(made, wanted.T))
half = np.radians(30) / 2
angles = RotationUtils.quat_to_eulZYX(np.array([np.cos(half), 0, 0, np.sin(half)]))
print("30 degrees about Z: angles", np.degrees(angles).round(1) + 0.0, "X goes to", RotationUtils.eul_2_rotm(angles)[:, 0].round(3) + 0.0)
for degrees in (90, 180):
    axis, angle = RotationUtils.rotm_2_axang(turn("Z", [np.radians(degrees)]))
    print(f"{degrees} degrees about Z: axis", axis.round(3) + 0.0, f"angle {np.degrees(angle):.1f}")
about_z, about_x, start = np.array([0, 0, 0, 0, 0, 1.0]), np.array([0, 0, 0, 1.0, 0, 0]), np.array([0, 1.0, 0])
for target in ([1.0, 0, 0], [2.0, 0, 0]):
    first, second = PadenKahan.paden_kahan_2(about_z, about_x, start, target)[0]
    reached = ExpMapping.exp_screw(np.append(about_z, first)) @ ExpMapping.exp_screw(np.append(about_x, second)) @ np.append(start, 1)
    print("to", target, "by", np.degrees([first, second]).round(1) + 0.0, "leads to", reached[:3].round(3) + 0.0)
PYTHON
cat >expected <<'TEXT'
XYZ is the product: True is its transpose: False
ZYZ is the product: True is its transpose: False
ZYX is the product: False is its transpose: True
30 degrees about Z: angles [30.  0.  0.] X goes to [ 0.866 -0.5    0.   ]
90 degrees about Z: axis [0. 0. 1.] angle 90.0
180 degrees about Z: axis [0. 0. 0.] angle 180.0
to [1.0, 0, 0] by [-90.   0.] leads to [1. 0. 0.]
to [2.0, 0, 0] by [-90.   0.] leads to [1. 0. 0.]
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
