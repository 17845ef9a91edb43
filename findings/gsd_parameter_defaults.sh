#!/usr/bin/env bash
# pyprofibus 1.13 sends zeros where the GSD of a slave gives default values of its parameters.
#
# A slave has three parameters: a bit that is on by default, -5 and 1000; its constant part is zeros. The guess: the User_Prm_Data
# for the master are 00 01 FB 03 E8, the constant part with the default of each parameter at its place (GSD revision 3,
# ExtUserPrmData and Ext_User_Prm_Data_Ref). What comes: 00 00 00 00 00; names and places
# of the three were read, their values were not.
set -euo pipefail
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet --disable-pip-version-check pyprofibus==1.13
cd "$work"
cat >drive.gsd <<'GSD'
#Profibus_DP
GSD_Revision = 3
Vendor_Name = "V"
Model_Name = "Drive"
Revision = "1.0"
Ident_Number = 0x1234
Protocol_Ident = 0
Station_Type = 0
FMS_supp = 0
Hardware_Release = "A"
Software_Release = "B"
12M_supp = 1
MaxTsdr_12M = 800
Redundancy = 0
Repeater_Ctrl_Sig = 2
24V_Pins = 0
Freeze_Mode_supp = 1
Sync_Mode_supp = 1
Auto_Baud_supp = 1
Set_Slave_Add_supp = 0
Min_Slave_Intervall = 1
Modular_Station = 0
Max_Diag_Data_Len = 6
Slave_Family = 1
PrmText = 1
Text(0) = "off"
Text(1) = "on"
EndPrmText
ExtUserPrmData = 1 "Stiffness control"
Bit(0) 1 0-1
Prm_Text_Ref = 1
EndExtUserPrmData
ExtUserPrmData = 2 "Offset"
Signed8 -5 -100-100
EndExtUserPrmData
ExtUserPrmData = 3 "Time"
Unsigned16 1000 0-65535
EndExtUserPrmData
Max_User_Prm_Data_Len = 5
Ext_User_Prm_Data_Const(0) = 0x00,0x00,0x00,0x00,0x00
Ext_User_Prm_Data_Ref(1) = 1
Ext_User_Prm_Data_Ref(2) = 2
Ext_User_Prm_Data_Ref(3) = 3
Module = "Telegram 3" 0xD9
EndModule
GSD
cat >try.py <<'PYTHON'
from pyprofibus.gsd.interp import GsdInterp

slave = GsdInterp.fromFile("drive.gsd")
print("parameters", [(one.refNr, one.name) for one in slave.getField("ExtUserPrmData")])
print("places", [(one.offset, one.refNr) for one in slave.getField("Ext_User_Prm_Data_Ref")])
print("User_Prm_Data", bytes(slave.getUserPrmData()).hex(" "))
PYTHON
cat >expected <<'TEXT'
parameters [(1, 'Stiffness control'), (2, 'Offset'), (3, 'Time')]
places [(1, 1), (2, 2), (3, 3)]
User_Prm_Data 00 00 00 00 00
TEXT
venv/bin/python try.py >seen 2>log || { cat log; exit 2; }
cat seen
diff expected seen >/dev/null || { echo "changed: expected was"; cat expected; exit 1; }
