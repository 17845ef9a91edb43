#!/usr/bin/env bash
# modbuslink 1.5.2 reads a position from registers the same way by either byte order, and a text by the second one from its end.
#
# A controller that has its low byte first in each register holds a position of 25000 in increments, a speed of 1.5 and a name of 13 letters; the client is told so. The guess: of the bytes ABCD
# the orders are ABCD (big, high word first), CDAB (big, low), BADC (little, high) and DCBA (little, low), as the package lists them itself, and a text is read
# on from register to register. What comes: the byte order changes nothing, ABCD and CDAB are all there is, and so the position of BADC and of DCBA is 43105, and the
# speed -2.98; written, they are as wrong. Of the text the registers come in reverse, and as the zeros behind it are then its beginning, nothing is left of
# it, or the single letter of its last register. By big endian all is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check modbuslink==1.5.2
cd "$work"
cat >try.py <<'PYTHON'
import struct

from modbuslink.utils.coder import PayloadCoder

ORDERS = {("big", "high"): "ABCD", ("big", "low"): "CDAB", ("little", "high"): "BADC", ("little", "low"): "DCBA"}


def registers(data):
    return list(struct.unpack(f">{len(data) // 2}H", data))


def shown(values):
    return " ".join(f"{value:04x}" for value in values)


for (byte_order, word_order), letters in ORDERS.items():
    position, speed = (registers(bytes(data["ABCD".index(letter)] for letter in letters)) for data in (struct.pack(">i", 25000), struct.pack(">f", 1.5)))
    print(
        f"{letters}: position {shown(position)} is read as {PayloadCoder.decode_int32(position, byte_order, word_order)},",
        f"written as {shown(PayloadCoder.encode_int32(25000, byte_order, word_order))}, speed read as {PayloadCoder.decode_float32(speed, byte_order, word_order):.3g}",
    )
name = b"Axis X of rig"
for count in (7, 8):
    for byte_order in ("big", "little"):
        text = name.ljust(2 * count, b"\0")
        held = [int.from_bytes(text[place : place + 2], byte_order) for place in range(0, len(text), 2)]
        print(f"name in {count} registers, {byte_order}: read as {PayloadCoder.decode_string(held, byte_order)!r}, written first as {PayloadCoder.encode_string('Axis X of rig', count, byte_order)[0]:04x}")
PYTHON
cat >expected <<'TEXT'
ABCD: position 0000 61a8 is read as 25000, written as 0000 61a8, speed read as 1.5
CDAB: position 61a8 0000 is read as 25000, written as 61a8 0000, speed read as 1.5
BADC: position 0000 a861 is read as 43105, written as 0000 61a8, speed read as -2.98
DCBA: position a861 0000 is read as 43105, written as 61a8 0000, speed read as -2.98
name in 7 registers, big: read as 'Axis X of rig', written first as 4178
name in 7 registers, little: read as 'g', written first as 0067
name in 8 registers, big: read as 'Axis X of rig', written first as 4178
name in 8 registers, little: read as '', written first as 0000
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
