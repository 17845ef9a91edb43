#!/usr/bin/env bash
# pyLSV2 1.8.0 alters a tool table by writing it as CSV with a decimal comma: the table for the control that follows has commas too.
#
# A tool table is read, written as CSV for an office program with decimal_char=",", and then written in the format of the control. The guess: the option
# concerns the CSV file alone ("to a CSV file with localized decimal separator", dump_csv of pyLSV2); rows and table of the control are as read. What comes: the rows themselves are altered in place, so that the length of
# tool 1 is +80,1234 in memory, float() refuses it, and the native table that is written afterwards has it with a comma, though a table written before the
# CSV has the point of the table that came from the control. Nothing is raised or printed. A whole number is not touched, so that a table of both looks half right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyLSV2==1.8.0
cd "$work"
cat >try.py <<'PYTHON'
from pathlib import Path

from pyLSV2.table_reader import NCTable

ROWS = [("T", "NAME", "L", "DL"), ("0", "ZERO", "+0", "+0"), ("1", "MILL_D10", "+80.1234", "-0.015"), ("2", "PROBE", "+120", "+0")]
TABLE = "BEGIN TOOL.T MM\n" + "".join(f"{a:<8}{b:<16}{c:<12}{d:<12}\n" for a, b, c, d in ROWS) + "[END]\n"
Path("tool.t").write_text(TABLE)
table = NCTable.parse_table(Path("tool.t"))


def show(when, name):
    table.dump_native(Path(name))
    written = NCTable.parse_table(Path(name))
    print(when, "L in memory", *(row["L"] for row in table.rows), "| in the native file", *(row["L"] for row in written.rows))


show("as read:          ", "before.t")
table.dump_csv(Path("point.csv"))
show("after CSV, point: ", "point.t")
table.dump_csv(Path("comma.csv"), ",")
show("after CSV, comma: ", "after.t")
try:
    print("length of tool 1:", float(table.rows[1]["L"]))
except ValueError as error:
    print("length of tool 1:", error)
PYTHON
cat >expected <<'TEXT'
as read:           L in memory +0 +80.1234 +120 | in the native file +0 +80.1234 +120
after CSV, point:  L in memory +0 +80.1234 +120 | in the native file +0 +80.1234 +120
after CSV, comma:  L in memory +0 +80,1234 +120 | in the native file +0 +80,1234 +120
length of tool 1: could not convert string to float: '+80,1234'
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
