#!/usr/bin/env bash
# pyladdersim 0.1.3 leaves out all rungs of a ladder behind the first one whose coil is off, so that a motor that runs cannot be stopped.
#
# The first rung shows a fault on a lamp, the second runs a motor while its stop is not pressed, a third counts parts. The guess: in each scan each rung is evaluated from top to bottom
# (IEC 61131-3, evaluation of networks), whatever the others give, and a pulse timer gives one pulse of its time (same standard, TP: an edge within the pulse has no effect; the
# elapsed time ends at PT). What comes: as soon as there is no fault, nothing else is evaluated; the motor keeps running when its stop is pressed, and no part is
# counted. With a fault all is right. A pulse of 3 scans is as long as edges keep coming, here 8, and a delay of 2 scans has an elapsed time of 6.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyladdersim==0.1.3
cd "$work"
cat >try.py <<'PYTHON'
from pyladdersim.components import Contact, CounterUp, InvertedContact, OnDelayTimer, Output, PulseTimer
from pyladdersim.ladder import Ladder, Rung

fault, stop, part = Contact("fault"), InvertedContact("stop"), Contact("part")
lamp, motor, full, counter = Output("lamp"), Output("motor"), Output("full"), CounterUp("parts", 10)
ladder = Ladder()
for rung in (Rung([fault, lamp]), Rung([stop, motor]), Rung([part, counter, full])):
    ladder.add_rung(rung)


def scan(what, parts=0):
    for on in [True, False] * parts or [False]:
        part.state = on
        ladder.scan_once()
    print(f"{what}: lamp {lamp.state}, motor {motor.state}, parts counted {counter.CV}")


fault.activate()
scan("fault, stop not pressed, 2 parts", 2)
fault.deactivate()
stop.activate()
scan("no fault, stop pressed, 3 parts", 3)
fault.activate()
scan("fault, stop pressed")
pulse, delay = PulseTimer("pulse", PT=3), OnDelayTimer("delay", PT=2)
inputs = (1, 0, 1, 0, 1, 0, 0, 0, 0, 0)
print("pulse of 3 scans:", *inputs, "gives", *(int(pulse.evaluate(bool(on))) for on in inputs))
print("delay of 2 scans:", *(f"{int(delay.evaluate(True))} at {delay.ET}" for _ in range(6)))
PYTHON
cat >expected <<'TEXT'
fault, stop not pressed, 2 parts: lamp True, motor True, parts counted 2
no fault, stop pressed, 3 parts: lamp False, motor True, parts counted 2
fault, stop pressed: lamp True, motor False, parts counted 2
pulse of 3 scans: 1 0 1 0 1 0 0 0 0 0 gives 1 1 1 1 1 1 1 0 0 0
delay of 2 scans: 0 at 1 1 at 2 1 at 3 1 at 4 1 at 5 1 at 6
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
