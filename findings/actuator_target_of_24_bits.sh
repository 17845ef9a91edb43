#!/usr/bin/env bash
# mksact 0.2.0 drops the upper bits of a target beyond 24 bits, so that an actuator told to go on turns back.
#
# An axis of a motor with 16384 counts a turn is moved to 500 and 511 turns, by ten turns more, and to 600 turns, within soft limits of 0 and 1000 turns. The target travels in
# a frame of 8 bytes as 24 signed bits (the manual of the drive gives -8388607 to 8388607 counts for it, 512 turns), while the place that is read has 48. The guess: a target
# that cannot be written is refused, or reached in several moves. What comes: 521 turns are 503 in the other direction and 600 are -424, without a word: the
# limits are compared with what was asked for, not with what was sent, and `wait=True` says that the move was completed.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check mksact==0.2.0 python-can==4.6.1
cd "$work"
cat >try.py <<'PYTHON'
import threading

import can
from mksact import COUNTS_PER_TURN, Actuator


def drive(bus):
    """The drive at the other end: it takes up what it is told and stands there at once."""
    place = 0
    for message in bus:
        code, data = message.data[0], message.data
        answers = [[code, 1]]
        if code == 0x31:
            answers = [[code, *place.to_bytes(6, "big", signed=True)]]
        elif code == 0xF5:
            place = int.from_bytes(data[4:7], "big", signed=True)
            answers.append([code, 2])
        for answer in answers:
            body = [*answer, (message.arbitration_id + sum(answer)) & 0xFF]
            bus.send(can.Message(arbitration_id=message.arbitration_id, is_extended_id=False, data=body))


with can.Bus(interface="virtual", channel="axis") as other:
    threading.Thread(target=drive, args=(other,), daemon=True).start()
    actuator = Actuator(channel="axis", interface="virtual", verbose=False)
    actuator.connect()
    actuator.set_zero()
    actuator.set_limits(0, 1000 * COUNTS_PER_TURN)
    for name, move, turns in (("to", actuator.move_abs, 500), ("to", actuator.move_abs, 511), ("by", actuator.move_rel, 10), ("to", actuator.move_abs, 600)):
        done = move(turns * COUNTS_PER_TURN, wait=True)
        print(f"{name} {turns} turns: done {done}, stands at {actuator.position() / COUNTS_PER_TURN:g}")
    actuator.close()
PYTHON
cat >expected <<'TEXT'
to 500 turns: done True, stands at 500
to 511 turns: done True, stands at 511
by 10 turns: done True, stands at -503
to 600 turns: done True, stands at -424
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
