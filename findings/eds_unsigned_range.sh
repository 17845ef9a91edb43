#!/usr/bin/env bash
# canmatrix 1.3.3 gives an unsigned object of an EDS the range of a signed one: 0x9237 is refused as a status word.
#
# 6041 of type UNSIGNED16, without limits in the EDS, becomes a signal of a DBC. The guess: 0 to 65535. What comes: an
# unsigned signal from -32768 to 32767. cantools decodes 0x9237 and then refuses to encode what it has decoded.
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
(message,) = [m for m in cantools.database.load_file("drive.dbc").messages if m.frame_id == 0x185]
(signal,) = message.signals
print("signed" if signal.is_signed else "unsigned", signal.minimum, signal.maximum)
found = message.decode(bytes([0x37, 0x92]))
print(found)
try:
    print(message.encode(found))
except cantools.database.EncodeError as error:
    print(error)
PYTHON
cat >expected <<'TEXT'
unsigned -32768 32767
{'Status': 37431}
Expected signal "Status" value smaller than or equal to 32767 in message "TPDO_1", but got 37431.
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
