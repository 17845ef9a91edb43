#!/usr/bin/env bash
# blark 0.8.3 reads Structured Text of Beckhoff's TwinCAT and refuses microseconds behind milliseconds in a duration of 64 bits.
#
# LTIME counts nanoseconds, and is what a PLC program compares time stamps of distributed clocks with. Its literals are those of
# TIME, with us and ns as two more places; the maker's page on the type prints one with all seven. The guess: what is read with
# five places is read with seven. What comes: us and ns are read where they stand alone, and behind any other unit neither is.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check blark==0.8.3
cd "$work"
cat >try.py <<'PYTHON'
from blark import parse_source_code

for value in ("LTIME#1d2h3m4s5ms", "LTIME#1s5ms", "LTIME#2us", "LTIME#1ns", "LTIME#1.5us", "LTIME#5ms2us", "LTIME#2us1ns", "LTIME#1s2us"):
    text = f"PROGRAM p\nVAR\n  edge : LTIME := {value};\nEND_VAR\nEND_PROGRAM\n"
    try:
        parse_source_code(text).transform()
        print(f"{value}: read")
    except Exception as error:
        print(f"{value}: {type(error).__name__}")
PYTHON
cat >expected <<'TEXT'
LTIME#1d2h3m4s5ms: read
LTIME#1s5ms: read
LTIME#2us: read
LTIME#1ns: read
LTIME#1.5us: read
LTIME#5ms2us: ValueError
LTIME#2us1ns: ValueError
LTIME#1s2us: ValueError
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
