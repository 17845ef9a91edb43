#!/usr/bin/env bash
# plctap 0.6.2 shows a position of 32 bits without its sign in the table of all that two registers may mean.
#
# A drive has its position as a DINT in two registers; -1000 increments are FFFF FC18. A read without a type gives the values by every type and order of words, so that one may see which is
# meant. The guess: -1000 under int32_big, as int16 beside it is signed, and as uint32 would be called what has no sign (IEC 61131-3, DINT has -2^31 to 2^31 - 1). What comes:
# 4294966296; with the words exchanged 4294966296 under int32_little. No entry of the table is the position: whoever looks for it, a person or a program, finds
# it among the positive numbers only. Floats and 16 bits are right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check plctap==0.6.2
cd "$work"
cat >try.py <<'PYTHON'
import struct

from plctap.protocols.common import interpret_all

for name, data in (("DINT -1000", struct.pack(">i", -1000)), ("DINT 1000", struct.pack(">i", 1000)), ("REAL -1.5", struct.pack(">f", -1.5))):
    high, low = struct.unpack(">2H", data)
    big, little = interpret_all([high, low]), interpret_all([low, high])
    kind = "int32" if name.startswith("DINT") else "float32"
    print(f"{name}: {high:04X} {low:04X}, {kind}_big {big[f'{kind}_big'][0]}, exchanged, {kind}_little {little[f'{kind}_little'][0]}")
print("int16 of FC18:", interpret_all([0xFC18])["int16"][0])
PYTHON
cat >expected <<'TEXT'
DINT -1000: FFFF FC18, int32_big 4294966296, exchanged, int32_little 4294966296
DINT 1000: 0000 03E8, int32_big 1000, exchanged, int32_little 1000
REAL -1.5: BFC0 0000, float32_big -1.5, exchanged, float32_little -1.5
int16 of FC18: -1000
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
