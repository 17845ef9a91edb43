#!/usr/bin/env bash
# plx-controls 0.1.0 simulates integers of a PLC without their width, and a remainder of a negative place with the other sign.
#
# It takes the body of a function block for Beckhoff, Siemens and Rockwell (Python syntax that is parsed, `%` becomes the operator MOD) and simulates it.
# A counter of 16 bits runs on from 65530 to 5; a place of -7 lies on a screw with pitch 3; a time in ns is divided by 1. The guess: 11, for a
# difference in UINT is one of 16 bits (a UINT has 0 to 65535 only); -2 turns and a rest of -1, since DIV goes towards zero and the rest is
# a - (a / b) * b (IEC 61131-3, integer types, DIV and MOD); and the time itself, for LINT has 64 bits. What comes: -65525 in the
# UINT, a rest of 2 beside -2 turns, which together are -4 and not -7, and a time 21 ns too early. No word is printed.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check plx-controls==0.1.0
cd "$work"
cat >try.py <<'PYTHON'
from plx.framework import DINT, LINT, UINT, fb, input_var, output_var
from plx.simulate import simulate


@fb
class Axis:
    now = input_var(UINT)
    before = input_var(UINT)
    moved = output_var(UINT)
    place = input_var(DINT)
    pitch = input_var(DINT)
    turns = output_var(DINT)
    rest = output_var(DINT)
    nanoseconds = input_var(LINT)
    part = input_var(LINT)
    whole = output_var(LINT)

    def logic(self):
        self.moved = self.now - self.before
        self.turns = self.place / self.pitch
        self.rest = self.place % self.pitch
        self.whole = self.nanoseconds / self.part


axis = simulate(Axis)
axis.now, axis.before = 5, 65530
axis.place, axis.pitch = -7, 3
axis.nanoseconds, axis.part = 1_764_478_800_123_456_789, 1
axis.scan()
print("UINT 5 - 65530:", axis.moved, "instead of", (5 - 65530) & 0xFFFF)
print("DINT -7 by 3:", axis.turns, "turns, rest", axis.rest, "instead of -1, together", axis.turns * 3 + axis.rest)
print("LINT by 1:", axis.whole - axis.nanoseconds, "ns beside the value")
PYTHON
cat >expected <<'TEXT'
UINT 5 - 65530: -65525 instead of 11
DINT -7 by 3: -2 turns, rest 2 instead of -1, together -4
LINT by 1: -21 ns beside the value
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
