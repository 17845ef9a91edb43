#!/usr/bin/env bash
# l5x 1.7 reads a number of 64 bits of a Logix controller as an empty dictionary, and no number that is shown in hex.
#
# An export of a controller has a counter, an encoder position of 64 bits (LINT), a length of double precision (LREAL), a mask that is shown in hex and one in binary, and a structure with
# a text. The guess: each has its value, or is refused by its type (Rockwell, Logix 5000 controllers import/export: LINT and LREAL are elementary types; the value stands as its
# radix shows it). What comes: {} for LINT and LREAL, alone and within a structure, as each type it does not know is taken for a structure, of which they have no members; the
# mask is refused in both radixes, though a write to it is taken; and a structure with a text has no value at all, as the text is taken for a member without a name.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check l5x==1.7
cd "$work"
cat >try.py <<'PYTHON'
import io

import l5x

TAGS = (
    ("Count", "DINT", "Decimal", "255"),
    ("Encoder", "LINT", "Decimal", "-5000000000"),
    ("Length", "LREAL", "Float", "12.0001"),
    ("Status", "DINT", "Hex", "16#0000_00ff"),
    ("Inputs", "SINT", "Binary", "2#0000_0101"),
)
MEMBERS = '<DataValueMember Name="State" DataType="INT" Radix="Decimal" Value="7"/><DataValueMember Name="Encoder" DataType="LINT" Radix="Decimal" Value="-5000000000"/>'
PART = '''<StructureMember Name="Part" DataType="STRING"><DataValueMember Name="LEN" DataType="DINT" Radix="Decimal" Value="5"/>
<DataValueMember Name="DATA" DataType="STRING" Radix="ASCII"><![CDATA['shaft']]></DataValueMember></StructureMember>'''
tags = "".join(
    f'<Tag Name="{name}" TagType="Base" DataType="{kind}" Radix="{radix}"><Data Format="Decorated"><DataValue DataType="{kind}" Radix="{radix}" Value="{value}"/></Data></Tag>'
    for name, kind, radix, value in TAGS
)
for name, members in (("Axis", MEMBERS), ("Job", MEMBERS + PART)):
    tags += f'<Tag Name="{name}" TagType="Base" DataType="{name}Type"><Data Format="Decorated"><Structure DataType="{name}Type">{members}</Structure></Data></Tag>'
export = f'''<?xml version="1.0" encoding="UTF-8" standalone="yes"?>
<RSLogix5000Content SchemaRevision="1.0" SoftwareRevision="32.00" TargetName="Rig" TargetType="Controller" ContainsContext="false">
<Controller Use="Target" Name="Rig"><DataTypes/><Modules/><Tags>{tags}</Tags><Programs/></Controller></RSLogix5000Content>'''
read = l5x.Project(io.StringIO(export)).controller.tags
for name in read.names:
    try:
        value = read[name].value
    except (KeyError, ValueError) as error:
        value = f"{type(error).__name__}, {error.args[0]}"
    shown = {tag[0]: f", {tag[1]} of {tag[3]}" for tag in TAGS}.get(name, "")
    print(f"{name}{shown}: {value}")
read["Status"].value = 15
print("Status, 15 written:", read["Status"].value)
PYTHON
cat >expected <<'TEXT'
Count, DINT of 255: 255
Encoder, LINT of -5000000000: {}
Length, LREAL of 12.0001: {}
Status, DINT of 16#0000_00ff: ValueError, invalid literal for int() with base 10: '16#0000_00ff'
Inputs, SINT of 2#0000_0101: ValueError, invalid literal for int() with base 10: '2#0000_0101'
Axis: {'State': 7, 'Encoder': {}}
Job: KeyError, Name
Status, 15 written: 15
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
