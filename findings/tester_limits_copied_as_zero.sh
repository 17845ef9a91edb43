#!/usr/bin/env bash
# stdfast 0.2.1 copies an STDF file of a tester with limits of 0 to 0 for every part behind the first.
#
# STDF V4 (Parametric Test Record, default data) lets a result leave out its last fields: the limits of the first
# result of a test then hold for all others. The file below does so, as testers do: limits 1 V to 2 V with the first part, none with the
# second. The guess: stdfast reads the left-out limits as absent, and a copy (get_records, write_stdf) says the
# same as the file. What comes: they are read as 0.0 with an OPT_FLAG of 0, which says that the limits are valid,
# and written so. In the copy 1.5 V stands against 0 V to 0 V. pystdf 1.4.0 reads both files and shows it.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check stdfast==0.2.1 pystdf==1.4.0
cd "$work"
cat >try.py <<'PYTHON'
import struct
from pathlib import Path

import stdfast
from pystdf.IO import Parser
from pystdf.V4 import ptr


def record(kind, sub, body):
    return struct.pack("<HBB", len(body), kind, sub) + body


def text(word):
    return bytes([len(word)]) + word.encode()


mir = struct.pack("<IIB3sHc", 0, 0, 1, b"   ", 0xFFFF, b" ") + text("LOT") + text("PART") + text("NODE")
mir += text("TESTER") + text("JOB") + bytes(25)
head = struct.pack("<IBBBB", 1000, 1, 1, 0, 0)
first = head + struct.pack("<f", 1.25) + text("gap") + text("") + struct.pack("<Bbbbff", 0x0E, 0, 0, 0, 1, 2) + text("V")
first += bytes(3) + struct.pack("<ff", 0, 0)
second = head + struct.pack("<f", 1.5) + text("gap") + text("")
pir = record(5, 10, bytes([1, 1]))
prr = record(5, 20, struct.pack("<BBBHHHhhI", 1, 1, 0, 1, 1, 1, -32768, -32768, 0) + text("1") + text("") + bytes(1))
file = record(0, 10, bytes([2, 4])) + record(1, 10, mir)
file += pir + record(15, 10, first) + prr + pir + record(15, 10, second) + prr
file += record(1, 20, struct.pack("<I", 0) + b" " + bytes(2))
Path("tester.stdf").write_bytes(file)
stdfast.write_stdf("copy.stdf", stdfast.get_records("tester.stdf"))


class Limits:
    def after_send(self, _, data):
        if data[0] is ptr:
            row = dict(zip(ptr.fieldNames, data[1]))
            print({name: row[name] for name in ("RESULT", "OPT_FLAG", "LO_LIMIT", "HI_LIMIT")})


for name in ("tester.stdf", "copy.stdf"):
    print(name)
    with open(name, "rb") as stream:
        parser = Parser(inp=stream)
        parser.addSink(Limits())
        parser.parse()
PYTHON
cat >expected <<'TEXT'
tester.stdf
{'RESULT': 1.25, 'OPT_FLAG': 14, 'LO_LIMIT': 1.0, 'HI_LIMIT': 2.0}
{'RESULT': 1.5, 'OPT_FLAG': None, 'LO_LIMIT': None, 'HI_LIMIT': None}
copy.stdf
{'RESULT': 1.25, 'OPT_FLAG': 14, 'LO_LIMIT': 1.0, 'HI_LIMIT': 2.0}
{'RESULT': 1.5, 'OPT_FLAG': 0, 'LO_LIMIT': 0.0, 'HI_LIMIT': 0.0}
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
