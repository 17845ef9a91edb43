#!/usr/bin/env bash
# classic-controlling 0.2.0 differentiates its first measurement from 0, so that a controller that starts at rest on its target pushes to its limit and keeps an output for good.
#
# An axis stands at 100 mm with 100 mm as target; a controller (gain 2, 1 s, 0.1 s, steps of 10 ms, output within 50) with the derivative of the measurement, whose use is said to be that
# nothing jumps, is stepped there. The guess: 0 from the first step on, as error, integral and change are 0. What comes: two steps at the lower limit, of a derivative that
# has the axis come from 0 in a step; what the limit cut off goes into the integral, so that the output is 16.4 of 50 from then on, though nothing has moved. At 0 mm all is 0,
# which is why a simulation that starts there does not show it. The derivative of the error, which is said to be the one that jumps, stays at 0 here.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check classic-controlling==0.2.0 numpy==2.4.6 scipy==1.17.1
cd "$work"
cat >try.py <<'PYTHON'
from classic_controlling import PID


def controller(of_measurement):
    return PID(kp=2.0, ti=1.0, td=0.1, dt=0.01, u_min=-50.0, u_max=50.0, derivative_on_measurement=of_measurement)


for place in (0.0, 100.0):
    for of_measurement in (True, False):
        made = controller(of_measurement)
        outputs = [made.step(place, place) for _ in range(501)]
        shown = ", ".join(f"{outputs[step]:.2f} after {step} steps" for step in (0, 1, 10, 100, 500))
        print(f"rests at {place:g}, derivative of the {'measurement' if of_measurement else 'error'}: {shown}")
PYTHON
cat >expected <<'TEXT'
rests at 0, derivative of the measurement: 0.00 after 0 steps, 0.00 after 1 steps, 0.00 after 10 steps, 0.00 after 100 steps, 0.00 after 500 steps
rests at 0, derivative of the error: 0.00 after 0 steps, 0.00 after 1 steps, 0.00 after 10 steps, 0.00 after 100 steps, 0.00 after 500 steps
rests at 100, derivative of the measurement: -50.00 after 0 steps, -50.00 after 1 steps, 15.38 after 10 steps, 16.36 after 100 steps, 16.36 after 500 steps
rests at 100, derivative of the error: 0.00 after 0 steps, 0.00 after 1 steps, 0.00 after 10 steps, 0.00 after 100 steps, 0.00 after 500 steps
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
