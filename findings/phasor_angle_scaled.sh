#!/usr/bin/env bash
# pyc37 1.0.2 multiplies the angle of a phasor by the scale of its magnitude, and refuses a frequency in Hz.
#
# A stream of measurements of the mains (IEEE C37.118.2) has phasors as magnitude and angle in 16 bits each: the magnitude counts by the PHUNIT of
# its channel (915527 * 0.00001 V here), the angle in steps of 0.0001 rad, whatever the unit (clause 6.3, PHASORS). FREQ is the deviation from the nominal
# frequency in mHz as an integer, but the actual frequency as a floating-point number (the same table of the edition of 2011, FREQ). The guess: 14635 and 5236 are
# 133987 V at 0.5236 rad, and 50.02 as a float is 50.02 Hz. What comes: the right magnitude at 47937 rad, without a word, and the frame with
# the float is refused, as if that were a deviation too. The same phasor as real and imaginary part is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyc37==1.0.2
cd "$work"
cat >try.py <<'PYTHON'
import collections.abc  # the package uses it without an import of its own
import struct

from pyc37.frame import CommonFrame, ConfigFrame2, FrameError

DATA_FORMAT = {"rectangular": 0, "polar": 1, "polar, frequency float": 9}


def crc(data):
    """CRC-CCITT of C37.118: polynomial 0x1021, start 0xFFFF."""
    value = 0xFFFF
    for byte in data:
        value ^= byte << 8
        for _ in range(8):
            value = ((value << 1) ^ 0x1021 if value & 0x8000 else value << 1) & 0xFFFF
    return value


def measured(form, phasor, frequency):
    """What comes of a data frame, written here by the layout of the standard."""
    config = ConfigFrame2(7, 1000000, 1, "Mains", 7, form, 1, 0, 0, ["VA"], [(915527, "v")], [], [], 50, 1, 50)
    body = struct.pack("!H", 0) + phasor + frequency
    size = 14 + len(body) + 2
    head = struct.pack("!HHHII", 0xAA01, size, 7, 1764478800, 0)
    frame = head + body
    frame += struct.pack("!H", crc(frame))
    return CommonFrame.convert2frame(frame, config).get_measurements()["measurements"][0]


for name, form in DATA_FORMAT.items():
    phasor = struct.pack("!hh", 12674, 7317) if form == 0 else struct.pack("!Hh", 14635, 5236)
    frequency = struct.pack("!ff", 50.02, 0.0) if form & 8 else struct.pack("!hh", 20, 0)
    try:
        seen = measured(form, phasor, frequency)
    except FrameError as error:
        print(f"{name}: {error}")
        continue
    ((magnitude, angle),) = seen["phasors"]
    print(f"{name}: {magnitude:.0f} V at {angle:.4f} rad, {seen['frequency']:.5f} Hz")
PYTHON
cat >expected <<'TEXT'
rectangular: 133983 V at 0.5236 rad, 50.02000 Hz
polar: 133987 V at 47936.9937 rad, 50.02000 Hz
polar, frequency float: Error while creating Data frame: FREQ must be in range -32.767 <= FREQ <= 32.767.
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
