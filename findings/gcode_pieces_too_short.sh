#!/usr/bin/env bash
# gcode-machine 1.0.3 cuts an incremental block into pieces that end before it does.
#
# With do_fractionize_lines it writes a long G1 as pieces of about 0.5 mm, for streaming with a feed that can be changed. The
# guess: the pieces of G91 G1 X10.007 sum up to 10.007, at most with a last piece that differs. What comes: twenty times 0.5, for each
# piece is rounded alone; the machine object itself is at 10.007. Each block adds to it: three of them end at
# 30.000 instead of 30.021. In G90 the end is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check gcode-machine==1.0.3
cd "$work"
cat >try.py <<'PYTHON'
import re

from gcode_machine import GcodeMachine


def pieces(*blocks):
    """The X words of all pieces, and the position at which the machine object is."""
    machine = GcodeMachine()
    machine.do_fractionize_lines = True
    words = []
    for block in blocks:
        machine.set_line(block)
        machine.strip()
        machine.tidy()
        machine.parse_state()
        for line in machine.fractionize():
            words += [float(word) for word in re.findall(r"X([-.\d]+)", line.partition(";")[0])]
        machine.done()
    return words, machine.pos_w[0]


words, position = pieces("G90", "G1X10.007F100", "G1X20.014", "G1X30.021")
print(f"G90: {len(words)} pieces, end {words[-1]:.3f}, machine {position:.3f}")
words, position = pieces("G91", "G1X10.007F100", "G1X10.007", "G1X10.007")
print(f"G91: {len(words)} pieces, end {sum(words):.3f}, machine {position:.3f}")
PYTHON
cat >expected <<'TEXT'
G90: 60 pieces, end 30.021, machine 30.021
G91: 60 pieces, end 30.000, machine 30.021
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
