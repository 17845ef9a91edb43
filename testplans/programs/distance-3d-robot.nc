%distance_3d_robot
; FCT-M3 12.4.3.3: a workpiece that is tilted by 30 degrees about Y, a circle of 20 mm radius on it with a dwell at each
; quadrant, and a surface that goes up and down. A is V.E.LEAN degrees, B and C are 0 against Z of the machine: #CS does not turn
; them, so that the tool is acos(cos 30 cos LEAN) off the normal of the workpiece. V.E.LAW 0: the programmed circle, 1: joint 3
; alone from the distance 80 cos 35.53 on, 2: along the tool, 3: along the normal.
N010 V.G.WZ_AKT.L = 80
N020 #TRAFO ON
N030 #DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]
N040 #CS ON[790, 0, 720, 0, 30, 0]
N050 G01 G90 X20 Y0 Z0 A=V.E.LEAN B0 C0 F30000
N052 #TIME 0.05
$SWITCH V.E.LAW
$CASE 1
N058 #DIST CTRL ON [CONST_DIST SET_DIST=65.104 MODE=ACS DIRECTION=Z]
$BREAK
$CASE 2
N060 #DIST CTRL ON [SURFACE SET_POS=0 MODE=ECS]
$BREAK
$CASE 3
N070 #DIST CTRL ON [SURFACE SET_POS=0 MODE=MCS]
$BREAK
$ENDSWITCH
N080 #TIME 0.2
N090 G17 G03 X0 Y20 I-20 J0 F12000
N100 #TIME 0.05
N110 G03 X-20 Y0 I0 J-20
N120 #TIME 0.05
N130 G03 X0 Y-20 I20 J0
N140 #TIME 0.05
N150 G03 X20 Y0 I0 J20
N160 #TIME 0.05
N999 M30
