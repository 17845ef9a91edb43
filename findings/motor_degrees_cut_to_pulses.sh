#!/usr/bin/env bash
# emm-stepper 1.1.0 cuts an angle to whole pulses, so that steps of one degree make 324 degrees of a turn and an angle of exactly 7 pulses makes 6.
#
# A motor of 3200 pulses a turn is turned by one degree 360 times, by a tenth of a degree 100 times, by a turn at once, and by each whole number of pulses up to a turn (0.1125
# degrees each, all of which are decimal numbers with four digits). The guess: the nearest pulse, 9 for a degree (8.89), 1 for a tenth of it (0.89), and for whole numbers
# that number. What comes: 8 and none, so that the motor does not move at all and the answer is True; 290 of the 3200 whole numbers come out one too small, since the quotient is a rounding below
# the number (0.7875 / 360 * 3200). Each relative step is late on the same side, both ways round, so that the way back does not show it.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check emm-stepper==1.1.0 pyserial==3.5
cd "$work"
cat >try.py <<'PYTHON'
import os
import threading
import tty

from emm_stepper import EmmDevice
from serial import Serial

line, other = os.openpty()
tty.setraw(other)
moves = []


def drive():
    """The drive at the other end: it notes the pulses of each move (FD, 13 bytes) and says that it was taken up."""
    while True:
        taken = b""
        while len(taken) < 13:
            taken += os.read(line, 13 - len(taken))
        moves.append(int.from_bytes(taken[6:10], "big"))
        os.write(line, bytes([taken[0], taken[1], 2, 0x6B]))


threading.Thread(target=drive, daemon=True).start()
motor = EmmDevice(Serial(os.ttyname(other), 115200, timeout=20), auto_test=False)
for degrees, times in ((1.0, 360), (0.1, 100), (360.0, 1)):
    moves.clear()
    answers = {motor.move_degrees(degrees) for _ in range(times)}
    print(f"{times} times {degrees:g}: answers {answers}, {moves[0]} pulses each, {sum(moves) * 360 / 3200:g} degrees of {degrees * times:g}")
moves.clear()
for pulses in range(1, 3201):
    motor.move_degrees(round(pulses * 0.1125, 4))
wrong = [(pulses, sent) for pulses, sent in enumerate(moves, 1) if sent != pulses]
print(f"{len(wrong)} of {len(moves)} whole numbers of pulses are wrong, all by {({sent - pulses for pulses, sent in wrong})}; the first are {wrong[:4]}")
PYTHON
cat >expected <<'TEXT'
360 times 1: answers {True}, 8 pulses each, 324 degrees of 360
100 times 0.1: answers {True}, 0 pulses each, 0 degrees of 10
1 times 360: answers {True}, 3200 pulses each, 360 degrees of 360
290 of 3200 whole numbers of pulses are wrong, all by {-1}; the first are [(7, 6), (14, 13), (28, 27), (56, 55)]
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
