#!/usr/bin/env bash
# pytwincatparser 0.5.6 finds no result of a TwinCAT method that names its access, and no length of a STRING in round brackets.
#
# IEC 61131-3 (third edition) lets a method have PUBLIC, PROTECTED, FINAL and so on before its name. In TwinCAT 3 (Beckhoff Information System, objects Method
# and STRING) a method without such a word is PUBLIC, and the length of a STRING is in round or square brackets. The guess: the same method has the same result
# type with any of these words and with none, and both spellings keep the length. What comes: BOOL without a word, nothing (None) with PUBLIC, PROTECTED or
# FINAL, though PUBLIC and PROTECTED themselves are found; and STRING(20) becomes STRING, which by default is of 80 characters, so that a client that lays out
# memory by it is 60 bytes off. STRING[20] is kept.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pytwincatparser==0.5.6
cd "$work"
cat >try.py <<'PYTHON'
from pathlib import Path

from pytwincatparser import Loader, Twincat4024Strategy

HEADS = ["METHOD Move : BOOL", "METHOD PUBLIC Move : BOOL", "METHOD PROTECTED Move : BOOL", "METHOD FINAL Move : BOOL", "METHOD Name : STRING",
         "METHOD Name : STRING(20)", "METHOD Name : STRING[20]"]


def guid(at):
    return f"{{00000000-0000-0000-0000-{at:012}}}"


methods = "".join(
    f'<Method Name="{head.split(" :")[0].split()[-1]}{at}" Id="{guid(at)}"><Declaration><![CDATA[{head.replace(" :", f"{at} :")}\n]]></Declaration>'
    "<Implementation><ST><![CDATA[]]></ST></Implementation></Method>"
    for at, head in enumerate(HEADS)
)
Path("FB_Axis.TcPOU").write_text(
    f'<?xml version="1.0" encoding="utf-8"?><TcPlcObject Version="1.1.0.1" ProductVersion="3.1.4024.12"><POU Name="FB_Axis" Id="{guid(99)}" SpecialFunc="None">'
    "<Declaration><![CDATA[FUNCTION_BLOCK FB_Axis\nVAR\nEND_VAR\n]]></Declaration><Implementation><ST><![CDATA[]]></ST></Implementation>"
    f"{methods}</POU></TcPlcObject>"
)
block = Loader(Twincat4024Strategy()).load_objects(Path("FB_Axis.TcPOU"))[0]
for head, method in zip(HEADS, block.methods, strict=True):
    print(f"{head:<30} result {method.returnType}, access {method.accessModifier}")
PYTHON
cat >expected <<'TEXT'
METHOD Move : BOOL             result BOOL, access None
METHOD PUBLIC Move : BOOL      result None, access PUBLIC
METHOD PROTECTED Move : BOOL   result None, access PROTECTED
METHOD FINAL Move : BOOL       result None, access None
METHOD Name : STRING           result STRING, access None
METHOD Name : STRING(20)       result STRING, access None
METHOD Name : STRING[20]       result STRING[20], access None
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
