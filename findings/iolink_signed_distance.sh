#!/usr/bin/env bash
# iolink-utils 0.1.0 reads signed and floating-point process data of an IO-Link sensor as unsigned integers.
#
# The IODD of a sensor gives its process data a distance of type IntegerT (two's complement), one of type Float32T (IEEE 754), or two unsigned
# values of 12 bits side by side. The guess: FF9C is -100, 3F000000 is 0.5 and 123456 is 291 and 1110, for type, length and bit offset say all
# (IO-Link interface specification, annex E; IODD specification, RecordItem). What comes: 65436, 1056964608, and 291 beside 1376: the class
# has unsigned fields for every number, and a field that shares a byte with the one above it is taken from the wrong bits.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check iolink-utils==0.1.0
cd "$work"
cat >try.py <<'PYTHON'
from iolink_utils.iodd.iodd import Iodd
from iolink_utils.processDataDecoder.processDataDecoder import createDecoderClass_PDIn

IODD = """<?xml version="1.0" encoding="utf-8"?>
<IODevice xmlns="http://www.io-link.com/IODD/2010/10" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
<DocumentInfo version="V1.0" releaseDate="2026-11-28" copyright="a"/>
<ProfileBody><DeviceIdentity vendorId="1" deviceId="2" vendorName="V"/>
<DeviceFunction><Features blockParameter="true" dataStorage="true"/>
<ProcessDataCollection><ProcessData id="PD"><ProcessDataIn id="PDI" bitLength="{bits}">
<Datatype xsi:type="RecordT" bitLength="{bits}">{items}</Datatype><Name textId="pd"/>
</ProcessDataIn></ProcessData></ProcessDataCollection></DeviceFunction></ProfileBody>
<CommNetworkProfile xsi:type="IOLinkCommNetworkProfileT" iolinkRevision="V1.1"><TransportLayers>
<PhysicalLayer bitrate="COM3" minCycleTime="1000" sioSupported="true" mSequenceCapability="43"/>
</TransportLayers></CommNetworkProfile></IODevice>
"""
ITEM = ('<RecordItem subindex="{number}" bitOffset="{offset}">'
        '<SimpleDatatype xsi:type="{kind}"{length}/><Name textId="{name}"/></RecordItem>')
CASES = (
    ("FF9C", (("distance", 0, "IntegerT", 16),)),
    ("3F000000", (("distance", 0, "Float32T", None),)),
    ("123456", (("distance", 12, "UIntegerT", 12), ("quality", 0, "UIntegerT", 12))),
)
for data, fields in CASES:
    items = "".join(
        ITEM.format(number=number, name=name, offset=offset, kind=kind,
                    length=f' bitLength="{length}"' if length else "")
        for number, (name, offset, kind, length) in enumerate(fields, 1)
    )
    path = "Vendor-Sensor-20261128-IODD1.1.xml"
    with open(path, "w") as file:
        file.write(IODD.format(bits=4 * len(data), items=items))
    layout = createDecoderClass_PDIn(Iodd(path).processDataDefinition)
    read = layout.from_buffer_copy(bytes.fromhex(data).ljust(8, b"\0"))
    print(data, *(f"{kind} {name} {getattr(read, name)}" for name, _, kind, _ in fields))
PYTHON
cat >expected <<'TEXT'
FF9C IntegerT distance 65436
3F000000 Float32T distance 1056964608
123456 UIntegerT distance 291 UIntegerT quality 1376
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
