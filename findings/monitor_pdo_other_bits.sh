#!/usr/bin/env bash
# canopen-monitor 4.1.0 shows a REAL32 of a PDO from its bytes in reverse, and packed bits from the wrong end of their byte.
#
# TPDO 1 of a probe is a distance of type REAL32 and a position of type INTEGER32; TPDO 2 packs two flags of one bit and a quality of six bits into
# one byte. The guess: 1.5 and -1000, then true, false and 10, for REAL32 goes with its lowest byte first as the integers do, and what is mapped first
# has the lowest bits (CiA 301, encoding rules and PDO mapping); the same with a byte more than is mapped, of which a receiver takes the first ones
# (the same, PDO write). What comes: the position is right, the distance is 6.9e-41; neither flag is ever true and the quality is 41, the whole byte. With
# a byte more all three are taken from that byte, for it counts from the end of the frame.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check canopen-monitor==4.1.0
cd "$work"
cat >try.py <<'PYTHON'
import struct

from canopen_monitor.can import Message
from canopen_monitor.parse import CANOpenParser, load_eds_file

OBJECTS = {0x2000: ("distance", 8), 0x2001: ("position", 4), 0x2002: ("contact", 1), 0x2003: ("lost", 1), 0x2004: ("quality", 5)}
PDOS = {0x1A00: (0x20000020, 0x20010020), 0x1A01: (0x20020001, 0x20030001, 0x20040006)}


def listed(name, indices):
    lines = "".join(f"{number}=0x{index:04X}\n" for number, index in enumerate(indices, 1))
    return f"[{name}]\nSupportedObjects={len(indices)}\n{lines}\n"


def variable(section, name, kind, default=""):
    return (
        f"[{section}]\nParameterName={name}\nObjectType=0x7\nDataType=0x{kind:04X}\n"
        f"AccessType=ro\nDefaultValue={default}\nPDOMapping=1\n\n"
    )


eds = listed("OptionalObjects", PDOS)
for index, mapped in PDOS.items():
    eds += f"[{index:04X}]\nParameterName=TPDO\nObjectType=0x9\nSubNumber={len(mapped) + 1}\n\n"
    eds += variable(f"{index:04X}sub0", "Number", 5, len(mapped))
    for number, entry in enumerate(mapped, 1):
        eds += variable(f"{index:04X}sub{number}", "Mapped", 7, f"0x{entry:08X}")
eds += listed("ManufacturerObjects", OBJECTS)
for index, (name, kind) in OBJECTS.items():
    eds += variable(f"{index:04X}", name, kind)
eds += "[DeviceCommissioning]\nNodeId=0x05\nNodeName=probe\n\n"
with open("probe.eds", "w") as file:
    file.write(eds)

parser = CANOpenParser({5: load_eds_file("probe.eds")})
for number, data in ((0x185, struct.pack("<fi", 1.5, -1000)), (0x285, bytes([0b001010_0_1])), (0x285, bytes([0b001010_0_1, 0]))):
    print(f"{number:03X}#{data.hex().upper()}", parser.parse(Message(number, data=list(data)))[0])
PYTHON
cat >expected <<'TEXT'
185#0000C03F18FCFFFF distance - 6.896490392174587e-41 position - -1000
285#29 contact - False lost - False quality - 41
285#2900 contact - False lost - False quality - 0
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
