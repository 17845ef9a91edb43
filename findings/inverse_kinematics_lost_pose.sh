#!/usr/bin/env bash
# ikdh 1.2.0 does not always find the joint angles that a robot has, though it is said to find all that there are.
#
# Joint angles of a robot that the package knows (ABB IRB 120), well within their limits and away from any singular place, give a pose; the pose goes to the
# solver. The guess: what it finds holds the angles that the pose was made of, whatever the pose, for the method is algebraic and needs no start (its page:
# all solutions). What comes: of 400 poses within a degree of one another some are found without them, about one in twelve, and others fully; which ones
# depends on the last bits of the numbers. The list is then shorter, without a word, or empty elsewhere. The iteration of the same package from a start two
# degrees away finds the angles each time. All that is found is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check ikdh==1.2.0 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
import ikdh
import numpy as np

robot = ikdh.load_robot("abb_irb_120_3_0_6.yaml")
solver = ikdh.Solver(robot.dh, robot.limits)
rng = np.random.default_rng(1)


def apart(found, angles):
    return np.abs((np.array(found) - angles + 180) % 360 - 180).max()


for name, middle in (("one place", (-60, 80, 30, 140, 110, -150)), ("another", (30, -20, 10, 40, 30, 0))):
    lost = wrong = far = 0
    for _ in range(400):
        angles = np.array(middle) + rng.uniform(-1, 1, 6)
        pose = ikdh.forward_kin(robot.dh, angles)
        found = solver.solve(pose)
        lost += not any(apart(each, angles) < 0.1 for each in found)
        wrong += sum(ikdh.fk_error(pose, ikdh.forward_kin(robot.dh, each)) > 1e-6 for each in found)
        near = solver.solve_from_seed(pose, angles + 2)
        far += not near or apart(near[0], angles) > 0.1
    share = "none" if not lost else "2 to 15 %" if 8 <= lost <= 60 else f"{lost} of 400"
    print(f"{name}: poses whose own angles are not found: {share}, wrong ones: {wrong}, not found from a near start: {far}")
PYTHON
cat >expected <<'TEXT'
one place: poses whose own angles are not found: 2 to 15 %, wrong ones: 0, not found from a near start: 0
another: poses whose own angles are not found: none, wrong ones: 0, not found from a near start: 0
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
