#!/usr/bin/env bash
# InterpolatePy 3.3.2 rounds the duration of a double-S motion to whole milliseconds, and the position jumps where braking begins.
#
# The motion of its page, from 0 to 10 with 5 per s, 10 per s2 and 30 per s3, takes 10/5 + 5/10 + 10/30 = 2.8333 s (Biagiotti and Melchiorri, double S).
# The guess: that, and a position that is continuous, as limits of jerk are there to see to. What comes: 2.833 s. Braking is counted back from that end, so
# that at its start the position jumps by the speed times what was rounded, 0.0017 here, and it brakes with 10.009.
# A move of a micrometre, 0.32 ms in metres, has the duration 0: it is a step.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check InterpolatePy==3.3.2
cd "$work"
cat >try.py <<'PYTHON'
from interpolatepy import DoubleSTrajectory, StateParams, TrajectoryBounds

motion = DoubleSTrajectory(StateParams(0.0, 10.0), TrajectoryBounds(5.0, 10.0, 30.0))
phases = motion.get_phase_durations()
braking = phases["acceleration"] + phases["constant_velocity"]
before, after = (float(motion.evaluate(braking + step)) for step in (-1e-6, 1e-6))
lowest = min(float(motion.evaluate_acceleration(0.0001 * at)) for at in range(28330))
print(f"10: {motion.get_duration():.6f} s, by hand {10 / 5 + 5 / 10 + 10 / 30:.6f} s")
print(f"10: in 2 us at {braking:.4f} s it goes {after - before:.6f}, at 5 per s {5 * 2e-6:.6f}; acceleration down to {lowest:.3f}")
# four equal phases of jerk: 2 * 1e6 * t^3 = 1e-6
motion = DoubleSTrajectory(StateParams(0.0, 1e-6), TrajectoryBounds(1.0, 100.0, 1e6))
print(f"1e-6: {motion.get_duration():.6f} s, by hand {4 * (1e-6 / 2e6) ** (1 / 3):.6f} s")
PYTHON
cat >expected <<'TEXT'
10: 2.833000 s, by hand 2.833333 s
10: in 2 us at 2.0000 s it goes 0.001677, at 5 per s 0.000010; acceleration down to -10.009
1e-6: 0.000000 s, by hand 0.000317 s
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
