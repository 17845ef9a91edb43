#!/usr/bin/env bash
# candied 2.2.0 (npm) reads a big-endian signal of a DBC from other bits, and a float as an integer.
#
# The start bit of a big-endian signal (@0) is its most significant bit, so that 7|16@0 is the first two bytes and 23|16@0 the third and fourth
# (Vector DBC; cantools 45.1.0 reads them so). The guess: 258 and 772 from 01 02 03 04, and 1.5 from a signal with SIG_VALTYPE_ 1.
# What comes: no number for the first and 516 for the second, whose last bit is put at the start bit; the float is 1069547520, though the
# reader lists its type as float. Little-endian integers are right, and so are big-endian signals of a single bit.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
cd "$work"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check cantools==45.1.0
npm install --silent --no-audit --no-fund --ignore-scripts candied@2.2.0 >/dev/null
cat >drive.dbc <<'DBC'
VERSION ""
NS_ :
BS_:
BU_: drive
BO_ 385 TPDO1: 8 drive
 SG_ first : 7|16@0- (1,0) [0|0] "" drive
 SG_ second : 23|16@0- (1,0) [0|0] "" drive
 SG_ little : 32|16@1- (1,0) [0|0] "" drive
BO_ 386 TPDO2: 4 drive
 SG_ speed : 0|32@1- (1,0) [0|0] "" drive
SIG_VALTYPE_ 386 speed : 1;
DBC
cat >try.mjs <<'SCRIPT'
import { readFileSync } from 'node:fs';
import { Can, Dbc } from 'candied';
const can = new Can();
can.database = new Dbc().load(readFileSync('drive.dbc', 'utf8'));
for (const [id, bytes] of [[385, [1, 2, 3, 4, 5, 0, 0, 0]], [386, [0, 0, 0xc0, 0x3f]]]) {
  const signals = can.decode(can.createFrame(id, bytes)).boundSignals;
  console.log('candied', ...[...signals].map(([name, one]) => `${name} ${one.value} (${one.boundData.signal.dataType})`));
}
SCRIPT
cat >try.py <<'PYTHON'
import cantools

bus = cantools.database.load_file("drive.dbc")
for number, data in ((385, bytes([1, 2, 3, 4, 5, 0, 0, 0])), (386, bytes([0, 0, 0xC0, 0x3F]))):
    print("cantools", *(f"{name} {value}" for name, value in bus.decode_message(number, data).items()))
PYTHON
cat >expected <<'TEXT'
candied first NaN (int16) second 516 (int16) little 5 (int16)
candied speed 1069547520 (float)
cantools first 258 second 772 little 5
cantools speed 1.5
TEXT
{ node try.mjs && venv/bin/python try.py; } >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
