#!/usr/bin/env bash
# dvg-pid-controller 2.2.0 integrates the time before it is switched on, so that the transfer that it calls bumpless jumps.
#
# A controller of 4 per s and of no gain else is made, the axis is homed for one or three seconds, and it is switched to automatic at an error of 1 with 50 of its range of 0 to 100
# as output so far. It is computed a few milliseconds later. The guess: the first output is 50 with the integral of these milliseconds, however long the homing took.
# What comes: 54 after one second, 62 after three, and at the end of the range after 13: the first step counts from where the object was made. Only one who computes while it is
# still in manual mode, which has no effect else, has the transfer that is promised.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check dvg-pid-controller==2.2.0 dvg-debug-functions==2.5.0 numpy==2.4.6
cd "$work"
cat >try.py <<'PYTHON'
import time

from dvg_pid_controller import Constants, PID_Controller

for kept, seconds in ((True, 1), (False, 1), (False, 3)):
    controller = PID_Controller(Kp=0.0, Ki=4.0, Kd=0.0)
    controller.setpoint = 11.0
    time.sleep(seconds)
    if kept:
        controller.compute(10.0)  # in manual mode: says False and does nothing but to take the time
    controller.set_mode(Constants.AUTOMATIC, 10.0, 50.0)
    time.sleep(0.005)
    controller.compute(10.0)
    jump = controller.output - 50
    print(f"{seconds} s in manual mode, {'computed' if kept else 'not computed'} there: output jumps by the integral of {jump / 4:.0f} s")
PYTHON
cat >expected <<'TEXT'
1 s in manual mode, computed there: output jumps by the integral of 0 s
1 s in manual mode, not computed there: output jumps by the integral of 1 s
3 s in manual mode, not computed there: output jumps by the integral of 3 s
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
