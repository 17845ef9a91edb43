#!/usr/bin/env bash
# festo-edcon 1.0.3 switches a parameter of a PROFIdrive drive on when its command is to write 0, and writes one letter of a text.
#
# `festo-edcon pnu -p 2209 write 0` writes a parameter of type BOOL (an external braking resistor is used), and `-p 2243 write 'Axis X'` the name of
# the device, of type STRING(128); the package has a list of the types. The guess: 00 goes to the drive, and the six letters. What comes:
# 01, for what the command line gives is the text 0, which is true as every text with a letter in it, and the letter A alone. The window of the tool
# hands on its texts in the same way. Numbers are right.
#
# The line to the drive is a class of this script that prints the bytes; nothing is sent.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check festo-edcon==1.0.3
cd "$work"
cat >try.py <<'PYTHON'
import sys
from edcon.cli import cli, pnu
from edcon.edrive.com_base import ComBase
from edcon.edrive.parameter_mapping import PnuMap


class Line(ComBase):
    def __init__(self, address):
        pass

    def write_pnu_raw(self, pnu, subindex=0, num_elements=1, value=b"\0"):
        print("drive", PnuMap()[pnu].data_type, PnuMap()[pnu].name, value.hex(" "))
        return True


pnu.ComModbus = Line
for number, value in ((2209, "1"), (2209, "0"), (2243, "Axis X"), (205, "0")):
    sys.argv = ["festo-edcon", "pnu", "-p", str(number), "write", value]
    cli.main()
PYTHON
cat >expected <<'TEXT'
drive BOOL Activate of external braking resistor 01
drive BOOL Activate of external braking resistor 01
drive STRING(128) Device name 41
drive INT Velocity override 00 00
TEXT
venv/bin/python try.py 2>log | { grep '^drive' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
