#!/usr/bin/env bash
# ingenialink 7.6.3 gives a signed parameter of 64 bits of a servo drive a range of two numbers, 9223372036854775806 and 9223372036854775807.
#
# A dictionary of a drive has parameters of 8 to 64 bits, signed and unsigned, without limits of their own, and one of 64 bits with limits. The guess: a parameter without limits has those of
# its type, so that with 64 bits and a sign a position of -25000 counts is within, and 0 (CiA 301, INTEGER64: -2^63 to 2^63 - 1). What comes: so for every type but the signed one
# of 64 bits, whose lowest value is the highest less one: a sign is missing. Zero, each position of a machine and the lowest value are below the minimum, and a program that keeps
# values within the limits of the dictionary makes 9223372036854775806 of them. With limits in the file it is right.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check ingenialink==7.6.3
cd "$work"
cat >try.py <<'PYTHON'
from ingenialink.ethercat.dictionary import EthercatDictionaryV2

TYPES = ("s8", "u8", "s16", "u16", "s32", "u32", "s64", "u64")
REGISTER = '<Register access="rw" address="{address}" address_type="NVM_NONE" dtype="{kind}" id="{name}" subnode="1" units="cnt">{limits}</Register>'
registers = [REGISTER.format(address=f"0x{number:04X}", kind=kind, name=kind, limits="") for number, kind in enumerate(TYPES, 0x100)]
registers.append(REGISTER.format(address="0x0200", kind="s64", name="s64 with limits", limits='<Range min="-100000" max="100000"/>'))
with open("drive.xdf", "w") as file:
    file.write(
        '<IngeniaDictionary><Header><Version>2</Version></Header><Body><Device firmwareVersion="1.0.0"><Registers>'
        + "".join(registers)
        + '</Registers></Device><Errors><Error id="0x00001111" affected_module="Axis" error_type="Cyclic">'
        + '<Labels><Label lang="en_US">Following error</Label></Labels></Error></Errors></Body></IngeniaDictionary>'
    )
drive = EthercatDictionaryV2("drive.xdf")
for name in (*TYPES, "s64 with limits"):
    low, high = drive.registers(1)[name].range
    values = (-25000, 0, 100)
    within = [low <= value <= high for value in values]
    print(f"{name}: {low} to {high};", *(f"{value} {'within' if fits else 'outside'}" for value, fits in zip(values, within)))
PYTHON
cat >expected <<'TEXT'
s8: -128 to 127; -25000 outside 0 within 100 within
u8: 0 to 255; -25000 outside 0 within 100 within
s16: -32768 to 32767; -25000 within 0 within 100 within
u16: 0 to 65535; -25000 outside 0 within 100 within
s32: -2147483648 to 2147483647; -25000 within 0 within 100 within
u32: 0 to 4294967295; -25000 outside 0 within 100 within
s64: 9223372036854775806 to 9223372036854775807; -25000 outside 0 outside 100 outside
u64: 0 to 18446744073709551615; -25000 outside 0 within 100 within
s64 with limits: -100000 to 100000; -25000 within 0 within 100 within
TEXT
venv/bin/python try.py 2>log >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
