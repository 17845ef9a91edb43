#!/usr/bin/env bash
# canopen 2.4.1 has every sub-index of an array from 1 to 255, whatever its EDS says.
#
# An EDS gives an array with sub-indices 0, 1 and 2. The guess: the dictionary has these and refuses 3 with KeyError, as a
# record does. What comes: any other up to 255 is made of the first element, and `in` finds it; an access
# to a sub-index that the device lacks shows only when it answers with an abort.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check canopen==2.4.1
cd "$work"
python3 - <<'PYTHON'
head = "[FileInfo]\nFileName=d.eds\nFileVersion=1\nFileRevision=0\nEDSVersion=4.0\n[DeviceInfo]\nVendorName=V\n"
lists = "[MandatoryObjects]\nSupportedObjects=0\n[OptionalObjects]\nSupportedObjects=2\n1=0x1010\n2=0x1018\n"


def variable(section, name):
    return f"[{section}]\nParameterName={name}\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\nPDOMapping=0\n"


def whole(index, kind):
    subs = "".join(variable(f"{index}sub{n}", f"{kind} {n}") for n in range(3))
    return f"[{index}]\nParameterName={kind}\nObjectType={'0x8' if kind == 'array' else '0x9'}\nSubNumber=3\n{subs}"


with open("d.eds", "w") as file:
    file.write(head + lists + whole("1010", "array") + whole("1018", "record"))
PYTHON
cat >try.py <<'PYTHON'
import canopen

od = canopen.import_od("d.eds", 5)
for index in (0x1010, 0x1018):
    found = [sub for sub in (2, 3, 255, 256) if sub in od[index]]
    print(hex(index), "elements", len(od[index]), "has", found)
print(od[0x1010][255].name)
PYTHON
cat >expected <<'TEXT'
0x1010 elements 3 has [2, 3, 255]
0x1018 elements 3 has [2]
array 1_ff
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
