#!/usr/bin/env bash
# canmatrix 1.3.3 lets a CANopen drive be the sender of the SDO requests that it gets.
#
# Requests to node 5 have the identifier 0x605 and come from the client, answers 0x585 from the node (CiA 301). The
# guess: an EDS that becomes a DBC names the node as sender of 0x585. What comes: it is named as sender of 0x605, and
# "PLC" of 0x585; the TPDO 0x185 is right. A tool that plays the other nodes by such a DBC sends the wrong half.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check canmatrix==1.3.3 canopen==2.4.1 cantools==45.1.0
cd "$work"
cat >try.py <<'PYTHON'
import canmatrix.formats
import cantools


def section(name, **keys):
    return f"[{name}]\n" + "".join(f"{key}={value}\n" for key, value in keys.items()) + "\n"


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
    file.write(section("OptionalObjects", SupportedObjects=3, **{"1": "0x1800", "2": "0x1A00", "3": "0x6041"}))
    file.write(record("1800", "TPDO 1", ("0x0007", "$NODEID+0x180"), ("0x0005", 1)))
    file.write(record("1A00", "Mapping of TPDO 1", ("0x0007", "0x60410010")))
    file.write(variable("6041", "Status", "0x0006", PDOMapping=1))


canmatrix.formats.dumpp(canmatrix.formats.loadp("drive.eds", eds_node_id=5), "drive.dbc")
for message in cantools.database.load_file("drive.dbc").messages:
    print(f"0x{message.frame_id:X}", message.senders)
PYTHON
cat >expected <<'TEXT'
0x605 ['drive']
0x585 ['PLC']
0x185 ['drive']
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
