#!/usr/bin/env bash
# canopen 2.4.1 has no default value where an EDS writes it in octal.
#
# Numbers of an EDS are those of ANSI C: 010 is 8 (CiA 306). The guess: 8, or an error. What comes: None, as if the
# object had no default value, without a message; 0x8 and 8 are read.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check canopen==2.4.1
cd "$work"
cat >drive.eds <<'FILE'
[FileInfo]
FileName=drive.eds
FileVersion=1
FileRevision=0
EDSVersion=4.0
Description=drive
CreationTime=10:00AM
CreationDate=11-28-2026
CreatedBy=a
ModificationTime=10:00AM
ModificationDate=11-28-2026
ModifiedBy=a

[DeviceInfo]
VendorName=V
VendorNumber=0
ProductName=P
ProductNumber=1
RevisionNumber=1
OrderCode=O
BaudRate_10=0
BaudRate_20=0
BaudRate_50=0
BaudRate_125=1
BaudRate_250=1
BaudRate_500=1
BaudRate_800=0
BaudRate_1000=1
SimpleBootUpMaster=0
SimpleBootUpSlave=1
Granularity=8
DynamicChannelsSupported=0
GroupMessaging=0
NrOfRXPDO=0
NrOfTXPDO=0
LSS_Supported=0

[DummyUsage]
Dummy0001=0
Dummy0002=0
Dummy0003=0
Dummy0004=0
Dummy0005=0
Dummy0006=0
Dummy0007=0

[Comments]
Lines=0

[MandatoryObjects]
SupportedObjects=3
1=0x1000
2=0x1001
3=0x1018

[1000]
ParameterName=Device type
ObjectType=0x7
DataType=0x0007
AccessType=ro
DefaultValue=0x00020192
PDOMapping=0

[1001]
ParameterName=Error register
ObjectType=0x7
DataType=0x0005
AccessType=ro
DefaultValue=0
PDOMapping=1

[1018]
ParameterName=Identity
ObjectType=0x9
SubNumber=2

[1018sub0]
ParameterName=Highest sub-index
ObjectType=0x7
DataType=0x0005
AccessType=ro
DefaultValue=1
PDOMapping=0

[1018sub1]
ParameterName=Vendor
ObjectType=0x7
DataType=0x0007
AccessType=ro
DefaultValue=0
PDOMapping=0

[OptionalObjects]
SupportedObjects=2
1=0x1003
2=0x6065

[1003]
ParameterName=Errors
ObjectType=0x8
CompactSubObj=4
DataType=0x0007
AccessType=ro
DefaultValue=0
PDOMapping=0

[6065]
ParameterName=Following error window
ObjectType=0x7
DataType=0x0007
AccessType=rw
DefaultValue=010
PDOMapping=0

[ManufacturerObjects]
SupportedObjects=0
FILE
cat >try.py <<'PYTHON'
import canopen

text = open("drive.eds").read()
for number in ("010", "0x8", "8"):
    open("one.eds", "w").write(text.replace("DefaultValue=010", f"DefaultValue={number}"))
    print(number, canopen.import_od("one.eds", 5)[0x6065].default)
PYTHON
cat >expected <<'TEXT'
010 None
0x8 8
8 8
TEXT
venv/bin/python try.py 2>log | { grep -vE '^\[[A-Z]+\] ' || true; } >seen || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
