#!/usr/bin/env bash
# canmatrix 1.2 adds the low limit of an object to each value of it in a PDO.
#
# An EDS limits 6064 from -1000 to 1000 and 606C not; TPDO 1 has both. The guess: the frame of the PDO decodes to the values
# that the drive sends, for a limit says what is allowed and changes no value (CiA 306, LowLimit). What comes: the limit is
# the offset of the signal too, so that 5 is read as -995; the object without limits is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check canmatrix==1.2 canopen==2.4.1
cd "$work"
python3 - <<'PYTHON'
def section(name, **entries):
    return f"[{name}]\n" + "".join(f"{key}={value}\n" for key, value in entries.items())


def variable(name, title, kind, access="ro", **more):
    return section(name, ParameterName=title, ObjectType="0x7", DataType=kind, AccessType=access, **more)


def record(index, title, *values):
    """Its sub-indices from 1: data type and value."""
    parts = [section(index, ParameterName=title, ObjectType="0x9", SubNumber=len(values) + 1)]
    parts.append(variable(f"{index}sub0", "Highest", "0x0005", PDOMapping=0, DefaultValue=len(values)))
    for sub, (kind, value) in enumerate(values, 1):
        parts.append(variable(f"{index}sub{sub}", f"Sub {sub}", kind, "rw", PDOMapping=0, DefaultValue=value))
    return "".join(parts)


with open("drive.eds", "w") as file:
    file.write(section("FileInfo", FileName="drive.eds", FileVersion=1, FileRevision=0, EDSVersion="4.0"))
    file.write(section("DeviceInfo", VendorName="V", ProductName="drive", BaudRate_1000=1, NrOfTXPDO=1))
    file.write(section("MandatoryObjects", SupportedObjects=0))
    file.write(section("OptionalObjects", SupportedObjects=4, **{"1": "0x1800", "2": "0x1A00", "3": "0x6064", "4": "0x606C"}))
    file.write(record("1800", "TPDO 1", ("0x0007", "$NODEID+0x180"), ("0x0005", 1)))
    file.write(record("1A00", "Mapping of TPDO 1", ("0x0007", "0x60640020"), ("0x0007", "0x606C0020")))
    file.write(variable("6064", "Position", "0x0004", PDOMapping=1, LowLimit=-1000, HighLimit=1000))
    file.write(variable("606C", "Velocity", "0x0004", PDOMapping=1))
PYTHON
cat >try.py <<'PYTHON'
import struct

import canmatrix.formats

(matrix,) = canmatrix.formats.loadp("drive.eds", eds_node_id=5).values()
(frame,) = [frame for frame in matrix.frames if frame.arbitration_id.id == 0x185]
sent = struct.pack("<ii", 5, 7)
for name, value in frame.decode(sent).items():
    signal = value.signal
    print(name, "limits", signal.min, signal.max, "offset", signal.offset, "value", value.phys_value)
PYTHON
cat >expected <<'TEXT'
Position limits -1000 1000 offset -1000 value -995
Velocity limits -2147483648 2147483647 offset 0 value 7
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
