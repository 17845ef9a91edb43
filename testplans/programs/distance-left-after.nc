%distance_left_after
; Started after distance-left.nc: what the program believes and where the axes are; one axis alone (V.E.TURN = 1: A to 0, else
; X); where #TRAFO begins; then Y and Z are named.
N010 #MSG SYN["Y=%f Z=%f", V.A.ABS.Y, V.A.ABS.Z]
N020 #MSG SYN["Y=%f Z=%f", V.A.ACT_POS.Y, V.A.ACT_POS.Z]
$IF V.E.TURN == 1
N030 G1 A0 F30000
$ELSE
N040 G1 X5 F30000
$ENDIF
N050 #TIME 0.02
N060 #MSG SYN["Y=%f Z=%f", V.A.ACT_POS.Y, V.A.ACT_POS.Z]
N070 V.G.WZ_AKT.L = 80
N080 #TRAFO ON
N090 #MSG SYN["Y=%f Z=%f", V.A.ABS.Y, V.A.ABS.Z]
N100 G1 Y10 Z20 F30000
N110 #TIME 0.02
N120 #MSG SYN["Y=%f Z=%f", V.A.ACT_POS.Y, V.A.ACT_POS.Z]
N999 M30
