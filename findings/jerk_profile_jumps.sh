#!/usr/bin/env bash
# two-point-interpolation 1.3.2 makes a motion with limited jerk in which the position jumps.
#
# A move from 0 to 10 with at most 2 per s2 and 4 per s3 does not get to its highest speed of 5; one from 0 to 400 with 1000 per s2 and 3000 per s3
# gets to its speed of 200 before it gets to its acceleration. The guess: position, speed and acceleration are continuous in both, as limits
# of jerk are there to see to; by hand the shortest take 5.000 and 2.516 s. What comes: 4.981 s, in which the position jumps by 0.083 in the middle
# of the braking, and 2.533 s, in which it jumps by 9.5 into the end, at a speed of 93. A shorter move, to 0.1, is continuous.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check two-point-interpolation==1.3.2 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
from two_point_interpolation.constant_jerk import TwoPointInterpolation

STEP_S = 1e-5
for end, acceleration, speed, jerk in ((0.1, 2, 5, 4), (10, 2, 5, 4), (400, 1000, 200, 3000)):
    move = TwoPointInterpolation()
    move.init(0.0, end, acceleration, speed, jerk)
    duration_s = move.calc_trajectory()
    points = [move.get_point(number * STEP_S) for number in range(int(duration_s / STEP_S) + 1)]
    points.append(move.get_point(duration_s))
    jumps = [(abs(right[0] - left[0]), left[1]) for left, right in zip(points, points[1:])]
    jump, before = max(jumps)
    print(f"to {end}: {duration_s:.3f} s, in 10 us at most {jump:.4f}, from a speed of {before:.1f}")
PYTHON
cat >expected <<'TEXT'
to 0.1: 0.928 s, in 10 us at most 0.0000, from a speed of 0.2
to 10: 4.981 s, in 10 us at most 0.0834, from a speed of 3.5
to 400: 2.533 s, in 10 us at most 9.4821, from a speed of 93.3
TEXT
venv/bin/python try.py 2>log | { grep '^to' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
