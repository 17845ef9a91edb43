#!/usr/bin/env bash
# a2lmodel 0.0.2 reads the words of an A2L by the lines on which they stand, and loses all that follows a block of one line.
#
# A measured position has a type, a conversion, limits and an address. Words of an A2L are separated by blanks, tabs or line ends alike (ASAM MCD-2 MC,
# lexical conventions), so that the same block may be one line or nine. The guess: the same measurement three times, and the second measurement behind it each
# time. What comes: right with a word on each line, and the two limits on one; with type and conversion on one line these are the description, the type
# is ECU_ADDRESS and there is no address; with the block on one line all is empty and the second one is not there. Nothing is raised or printed.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check a2lmodel==0.0.2
cd "$work"
cat >try.py <<'PYTHON'
from a2lmodel import A2LParser

HEAD = 'ASAP2_VERSION 1 71\n/begin PROJECT rig "axis"\n/begin MODULE drive "servo"\n'
NEXT = '/begin MEASUREMENT\nspeed\n"actual speed"\nSLONG\ncm_mm\n0\n0\n-50 50\nECU_ADDRESS 0x20000014\n/end MEASUREMENT\n'
TAIL = "/end MODULE\n/end PROJECT\n"
WORDS = ["/begin MEASUREMENT", "position", '"actual position"', "SLONG", "cm_mm", "0", "0", "-1000 1000", "ECU_ADDRESS 0x20000010",
         "/end MEASUREMENT"]
LAYOUTS = {
    "a line each": "\n".join(WORDS),
    "three lines": "\n".join((" ".join(WORDS[:3]), " ".join(WORDS[3:8]), *WORDS[8:])),
    "one line   ": " ".join(WORDS),
}
for name, block in LAYOUTS.items():
    model = A2LParser().parse_text(HEAD + block + "\n" + NEXT + TAIL)
    first, *others = model.measurements
    print(f"{name}: {first.name}, {first.description!r}, type {first.datatype!r}, conversion {first.compu_method!r},",
          f"{first.lower_limit} to {first.upper_limit}, at {first.ecu_address}; then", *(other.name for other in others))
PYTHON
cat >expected <<'TEXT'
a line each: position, 'actual position', type 'SLONG', conversion 'cm_mm', -1000.0 to 1000.0, at 536870928; then speed
three lines: position, 'SLONG cm_mm 0 0 -1000 1000', type 'ECU_ADDRESS', conversion '', None to None, at None; then speed
one line   : position, '', type '', conversion '', None to None, at None; then
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
