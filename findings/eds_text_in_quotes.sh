#!/usr/bin/env bash
# dcf-tools 2.4.2 wants the text of an object in quotes, canopen 2.4.1 takes the quotes for a part of the text.
#
# An EDS gives 1008 the default value `Servo drive 2`. The guess: both read that text, for a VISIBLE_STRING is the characters
# behind the equals sign (CiA 306). What comes: dcf2dev, which writes an EDS as a table in C, ends with a SyntaxError; it
# evaluates the text as a literal of Python. With quotes it writes the text, and canopen has a name with quotes in it: no
# line is right for both.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check dcf-tools==2.4.2 canopen==2.4.1
cd "$work"
for text in 'Servo drive 2' '"Servo drive 2"'; do
  cat >drive.eds <<FILE
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
VendorNumber=0x1
ProductName=P
ProductNumber=0x2
RevisionNumber=0x0
OrderCode=x
BaudRate_10=0
BaudRate_20=0
BaudRate_50=0
BaudRate_125=0
BaudRate_250=0
BaudRate_500=0
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
PDOMapping=0

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
DefaultValue=0x1
PDOMapping=0

[OptionalObjects]
SupportedObjects=1
1=0x1008

[1008]
ParameterName=Device name
ObjectType=0x7
DataType=0x0009
AccessType=const
DefaultValue=$text
PDOMapping=0

[ManufacturerObjects]
SupportedObjects=0
FILE
  echo "DefaultValue=$text"
  venv/bin/python - <<'PYTHON'
import canopen

print("canopen:", canopen.import_od("drive.eds", 5)[0x1008].default)
PYTHON
  venv/bin/dcf2dev drive.eds Drive >table.c 2>log && status=0 || status=$?
  echo "dcf2dev: exit code $status"
  grep -ohE '^SyntaxError|\.def = \{ \.vs = .*' log table.c || true
done >seen
cat >expected <<'TEXT'
DefaultValue=Servo drive 2
canopen: Servo drive 2
dcf2dev: exit code 1
SyntaxError
DefaultValue="Servo drive 2"
canopen: "Servo drive 2"
dcf2dev: exit code 0
.def = { .vs = CO_VISIBLE_STRING_C("Servo drive 2") },
TEXT
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
