#!/usr/bin/env bash
# structured-text-formatter 0.1.5 writes blanks into texts of a PLC program, and finds the program unchanged.
#
# It aligns the assignments of Structured Text and compares the tokens before and after, so that no program changes. The guess: what
# stands between quotes is left alone: between single ones, between the double ones of a WSTRING, and behind an apostrophe that is
# written $' (IEC 61131-3, character strings). What comes: the second and the third text get blanks before their :=, as many as the
# names beside them are short, and the check passes. A drive or a display that is sent the text gets another one.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check structured-text-formatter==0.1.5
cd "$work"
cat >main.st <<'FILE'
PROGRAM Main
VAR
    single, apostrophe : STRING;
    wide : WSTRING;
    position_of_probe : DINT;
END_VAR
position_of_probe := 0;
single := 'X:=10';
wide := "X:=10";
apostrophe := 'probe$'s X:=10';
END_PROGRAM
FILE
cat >expected <<'TEXT'
1 reformatted, 0 FAILED
single                    := 'X:=10';
wide := "X                :=10";
apostrophe := 'probe$'s X :=10';
TEXT
venv/bin/st-formatter --write main.st >log 2>&1 || { cat log; exit 2; }
{ grep -o '1 reformatted, 0 FAILED' log; grep -E "['\"]" main.st | sed 's/^ *//'; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
