#!/usr/bin/env bash
# plcopener 0.1.0 empties each program that declares no variables of its own when the texts that it wrote go back into the project.
#
# A project in PLCopen XML has a program with a variable, one that works on global variables alone, one that calls the two, and one that names END_VAR in a comment of its
# statements. All are extracted to text files and, not edited, inserted again. The guess: the statements come back as they were; declarations are optional (IEC 61131-3, the body of a
# program stands behind declarations, if any). What comes: the files are right, but what is read back as statements is what follows the last END_VAR of a file: nothing for
# the two programs without a declaration, and of the last one what is behind the word, with the end of a comment as its first words. The count of what was updated is 4, without a word.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check plcopener==0.1.0
cd "$work"
cat >try.py <<'PYTHON'
import contextlib
import io
import xml.etree.ElementTree as ET
from pathlib import Path

from plcopener import ProjectExtractor, ProjectInserter

VARIABLE = "<localVars><variable name='count'><type><INT/></type></variable></localVars>"
PROGRAMS = {
    "Counted": (VARIABLE, "count := count + 1;"),
    "Homed": ("", "Gvl.homed := TRUE;\nGvl.state := 2;"),
    "Main": ("", "Counted();\nHomed();"),
    "Noted": (VARIABLE, "count := 1;\n(* see END_VAR above *)\ncount := count * 2;"),
}
KEPT = "http://www.3s-software.com/plcopenxml/objectid"
PROGRAM = """<pou name="{name}" pouType="program"><interface>{variables}</interface>
<body><ST><xhtml xmlns="http://www.w3.org/1999/xhtml">{body}</xhtml></ST></body>
<addData><data name="{kept}" handleUnknown="discard"><ObjectId>{name}</ObjectId></data></addData></pou>"""
PROJECT = """<?xml version="1.0" encoding="utf-8"?>
<project xmlns="http://www.plcopen.org/xml/tc6_0200"><types><dataTypes/><pous>{programs}</pous></types><instances><configurations/></instances></project>"""


def bodies(path):
    pous = [element for element in ET.parse(path).iter() if element.tag.endswith("}pou")]
    return {pou.get("name"): "".join(next(e for e in pou.iter() if e.tag.endswith("}xhtml")).itertext()).strip() for pou in pous}


before, after = Path("axis.xml"), Path("back.xml")
before.write_text(PROJECT.format(programs="".join(PROGRAM.format(name=name, variables=v, body=b, kept=KEPT) for name, (v, b) in PROGRAMS.items())))
with contextlib.redirect_stdout(io.StringIO()):
    ProjectExtractor(before).extract(Path("st"))
    done = ProjectInserter(before).insert(Path("st"), output_path=after)
print("programs updated:", done["updated_pous"])
was, now = bodies(before), bodies(after)
for name in PROGRAMS:
    text = Path("st", name + ".st").read_text()
    print(f"{name}: file has the statements {was[name] in text}, was {was[name]!r}, is {'the same' if now[name] == was[name] else repr(now[name])}")
PYTHON
cat >expected <<'TEXT'
programs updated: 4
Counted: file has the statements True, was 'count := count + 1;', is the same
Homed: file has the statements True, was 'Gvl.homed := TRUE;\nGvl.state := 2;', is ''
Main: file has the statements True, was 'Counted();\nHomed();', is ''
Noted: file has the statements True, was 'count := 1;\n(* see END_VAR above *)\ncount := count * 2;', is 'above *)\ncount := count * 2;'
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
