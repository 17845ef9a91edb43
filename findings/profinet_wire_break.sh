#!/usr/bin/env bash
# profinet-py 0.6.6 reads a wire break of one channel as an overvoltage of the whole submodule, of which nothing is left.
#
# Record 800C of a submodule holds a diagnosis of channel 3: wire break, appears, an input of 16 bits. The guess: that is what comes; a block of
# channel diagnosis ends its head with the user structure identifier 8000, and after it each entry has its own number, properties
# and error type (IEC 61158-6-10, DiagnosisData and ChannelDiagnosisData; Wireshark 4.0.17 dissects the bytes so). What comes: one entry with number and
# properties of the head and the error type 3, which is the number of the channel. All properties have other places too: with the right 16 bits, 2805,
# an error that appears has the specifier of one that is gone. `read_diagnosis` of the package reads the record by this function.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check profinet-py==0.6.6
cd "$work"
cat >try.py <<'PYTHON'
import struct
from profinet.diagnosis import ChannelProperties, decode_channel_error_type, parse_diagnosis_block

CHANNEL, INPUT, APPEARS, BITS_16, WIRE_BREAK = 3, 1, 1, 5, 6
properties = INPUT << 13 | APPEARS << 11 | BITS_16
head = struct.pack(">HIHHHHH", 0x0101, 0, 1, 1, 0x8000, APPEARS << 11, 0x8000)
entry = struct.pack(">HHH", CHANNEL, properties, WIRE_BREAK)
record = struct.pack(">HH", 0x0010, len(head + entry)) + head + entry
print("sent:", f"channel {CHANNEL:X}, {decode_channel_error_type(WIRE_BREAK)}, properties {properties:04X}: APPEARS, INPUT")
for found in parse_diagnosis_block(record).entries:
    read = found.channel_properties
    print(f"read: channel {found.channel_number:X}, {found.error_type_name}, properties {read.raw:04X}: {read.specifier.name}")
read = ChannelProperties.from_uint16(properties)
print(f"properties {properties:04X} alone: {read.specifier.name}, {read.direction.name}")
PYTHON
cat >expected <<'TEXT'
sent: channel 3, Line break, properties 2805: APPEARS, INPUT
read: channel 8000, Overvoltage, properties 0800: ALL_DISAPPEARS
properties 2805 alone: ALL_DISAPPEARS, INPUT
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
