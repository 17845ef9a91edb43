#!/usr/bin/env bash
# canopen 2.4.1 writes an EDS in which a negative default value is no number, and reads it back as none.
#
# The guess: export_od writes the default -5 of an INTEGER32 as -5 or 0xFFFFFFFB (CiA 306 has both). What comes:
# 0x-5. Its own import_od then has no default value, without a word; limits of the same object are right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check canopen==2.4.1
cd "$work"
cat >try.py <<'PYTHON'
import canopen
from canopen.objectdictionary import INTEGER32, ODVariable

dictionary = canopen.ObjectDictionary()
target = ODVariable("Target position", 0x607A)
target.data_type, target.default, target.min, target.max = INTEGER32, -5, -100, 100
dictionary.add_object(target)
canopen.export_od(dictionary, "drive.eds")
lines = open("drive.eds").read().splitlines()
print([line for line in lines if line.startswith(("DefaultValue", "LowLimit"))])
back = canopen.import_od("drive.eds")[0x607A]
print(back.default, back.min, back.max)
PYTHON
cat >expected <<'TEXT'
['DefaultValue=0x-5', 'LowLimit=-100']
None -100 100
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
