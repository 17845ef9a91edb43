#!/usr/bin/env bash
# s7datablock 0.0.2 reads an Int of a Siemens controller with its bytes swapped, a DInt not, and puts a word behind a single byte at another place than the controller.
#
# A data block has a speed of 1000 (Int), a position of 25000 (DInt), a dwell of 1.5 s (Time) and an instant on Sunday, 29 November 2026 (DTL). The guess: each is read as it is, for an S7
# controller stores all numbers with the high byte first, a Time is a signed number of milliseconds, and in a DTL Sunday is day 1 (Siemens, S7-1500 programming, data types).
# What comes: the speed is -6141 and the dwell 43 days; 1000 written is E8 03, again -6141 for the controller, while DInt and Real are right. A dwell before zero is refused, and the
# weekday that is written for Sunday is 0, for Monday 1, that is Sunday. In a second block a byte follows a bit and a word a byte; in blocks without optimized access a byte takes the
# next byte and a word the next even one (mode 1.0, speed 2.0, tool 4.0, position 6.0). The package has
# them at 2, 3, 5 and 6: the mode is the high byte of the speed.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check s7datablock==0.0.2 python-snap7==3.3.0
cd "$work"
cat >try.py <<'PYTHON'
import datetime
import io
import struct

from s7datablock import S7DataBlock


class Controller:
    """The data of a block, as a client of snap7 gives and takes it."""

    def __init__(self, data):
        self.data = bytearray(data)

    def db_read(self, number, start, size):
        return bytearray(self.data[start : start + size])

    def db_write(self, number, start, data):
        self.data[start : start + len(data)] = data


def block(*members):
    text = "\n".join(f"{name} : {kind};" for name, kind in members)
    return S7DataBlock.from_definition_file(
        io.StringIO(f'TYPE "axis"\nVERSION : 0.1\nSTRUCT\n{text}\nEND_STRUCT;\nEND_TYPE\nDATA_BLOCK "axis"\nVERSION : 0.1\n"axis"\nBEGIN\nEND_DATA_BLOCK\n'), db_number=1
    )


axis = block(("Speed", "Int"), ("Position", "DInt"), ("Dwell", "Time"), ("When", "DTL"))
controller = Controller(struct.pack(">hii", 1000, 25000, 1500) + struct.pack(">HBBBBBBI", 2026, 11, 29, 1, 12, 0, 0, 0))
axis.GET(controller)
print("speed 1000, position 25000, dwell 1.5 s:", axis["Speed"], axis["Position"], axis["Dwell"], axis["When"])
axis["Speed"], axis["Position"], axis["Dwell"] = 1000, 25000, datetime.timedelta(seconds=1.5)
axis.SET(controller)
print("the same, written:", *struct.unpack_from(">hii", controller.data), controller.data[:2].hex(" "))
for day in (29, 30):
    axis["When"] = datetime.datetime(2026, 11, day)
    print(f"{axis['When']:%A}: day", axis["When.WEEKDAY"])
try:
    axis["Dwell"] = datetime.timedelta(seconds=-1.5)
except struct.error as error:
    print("dwell of -1.5 s:", error)
state = block(("Ready", "Bool"), ("Mode", "Byte"), ("Speed", "Word"), ("Tool", "USInt"), ("Position", "DInt"))
state.GET(Controller(struct.pack(">BBHBxi", 1, 2, 1000, 7, 25000)))
print("ready, mode 2, speed 1000, tool 7, position 25000:", state.to_dict())
print("places:", {name: field.offset for name, field in state.mapping.items()}, "length", state.db_size)
PYTHON
cat >expected <<'TEXT'
speed 1000, position 25000, dwell 1.5 s: -6141 25000 42 days, 17:21:55.200000 2026-11-29 12:00:00
the same, written: -6141 25000 -603652096 e8 03
Sunday: day 0
Monday: day 1
dwell of -1.5 s: argument out of range
ready, mode 2, speed 1000, tool 7, position 25000: {'Ready': True, 'Mode': 3, 'Speed': 59399, 'Tool': 0, 'Position': 25000}
places: {'Ready': 0, 'Mode': 2, 'Speed': 3, 'Tool': 5, 'Position': 6} length 10
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
