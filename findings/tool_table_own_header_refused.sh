#!/usr/bin/env bash
# pyLSV2 1.8.0 writes a tool table of a control of the newer kind with a header that its own reader refuses.
#
# Tables of newer controls name their version in the header, in quotes and with the word Update: parse_header of pyLSV2 documents this form and reads it. The
# guess: a table that is read and written again has the same header, or is at least read again. What comes: the version is written bare, without Update and quotes, the date and the
# mark U are gone, and the file is refused as one of incorrect header. A table made new by NCTable(...) without a version gets the word Version and nothing behind it, and
# is refused likewise. Only a table that was read without any version comes back.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyLSV2==1.8.0
cd "$work"
cat >try.py <<'PYTHON'
from pathlib import Path

from pyLSV2.table_reader import NCTable


def again(name, table):
    path = Path("TOOL.T")
    table.dump_native(path)
    print(f"{name}: written as {path.read_text().splitlines()[0]!r}", end=", ")
    try:
        print("read again:", NCTable.parse_table(path).rows)
    except ValueError as error:
        print("refused:", error)


for header in ("BEGIN TOOL.T MM", "BEGIN TOOL.T MM Version: 'Update:4.0'", "BEGIN TOOL.T MM Version: 'Update:4.0 Date:2024-05-06' U"):
    Path("read.t").write_text(f"{header}\n{'T':<8}{'L':<12}\n{'1':<8}{'+80.1234':<12}\n[END]\n")
    again(header, NCTable.parse_table(Path("read.t")))
new = NCTable(name="TOOL", suffix="t", has_unit=True, is_metric=True)
new.append_column("T", 0, 8)
new.append_column("L", 8, 20)
new.append_row({"T": "1", "L": "+80.1234"})
again("made new", new)
PYTHON
cat >expected <<'TEXT'
BEGIN TOOL.T MM: written as 'BEGIN TOOL.T MM', read again: [{'T': '1', 'L': '+80.1234'}]
BEGIN TOOL.T MM Version: 'Update:4.0': written as 'BEGIN TOOL.T MM Version:4.0', refused: File has wrong format: incorrect header: BEGIN TOOL.T MM Version:4.0
BEGIN TOOL.T MM Version: 'Update:4.0 Date:2024-05-06' U: written as 'BEGIN TOOL.T MM Version:4.0', refused: File has wrong format: incorrect header: BEGIN TOOL.T MM Version:4.0
made new: written as 'BEGIN TOOL.T MM Version:', refused: File has wrong format: incorrect header: BEGIN TOOL.T MM Version:
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
