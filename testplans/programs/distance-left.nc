%distance_left
; An offset that something leaves. V.E.KIND: 1 = 3D control along the tool, 2 = that of axis Z. V.E.CAUSE: 1 a reset comes from
; the PLC, 2 the offset gets to max_deviation, 3 the end of the program, 4 #TRAFO OFF in FREEZE. V.E.PLACE: the surface as axis Z
; counts, from the A axis to the clamping point are 100 mm cos A. Where the tool counts its length of 80 mm is in the position of Z.
N010 V.G.WZ_AKT.L = 80
N020 #TRAFO ON
$IF V.E.KIND == 1
N030 #DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]
N032 #DIST CTRL ON [SURFACE SET_POS=0 MODE=ECS]
$ELSE
N040 Z[DIST_CTRL SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.OWN SET_POS=V.E.PLACE ON]
$ENDIF
N050 #TIME 0.3
$IF V.E.CAUSE == 1
N060 #TIME 5
$ENDIF
$IF V.E.CAUSE == 4
$IF V.E.KIND == 1
N070 #DIST CTRL FREEZE
$ELSE
N080 Z[DIST_CTRL FREEZE]
$ENDIF
N090 #TRAFO OFF
N100 #TIME 0.02
N110 #MSG SYN["Y=%f Z=%f", V.A.ACT_POS.Y, V.A.ACT_POS.Z]
N120 G1 A0 F30000  ; A alone
N130 #TIME 0.02
N140 #MSG SYN["Y=%f Z=%f", V.A.ACT_POS.Y, V.A.ACT_POS.Z]
$IF V.E.KIND == 1
N150 #DIST CTRL WAIT OFF
$ELSE
N160 Z[DIST_CTRL OFF WAIT]
$ENDIF
N170 #TIME 0.02
N180 #MSG SYN["Y=%f Z=%f", V.A.ACT_POS.Y, V.A.ACT_POS.Z]
$ENDIF
N999 M30
