%distance_3d_after
; After a reset or the end of another program: where the axes are, with the offset that was left in their positions, on again
; in the same mode, then off; the last position is that of the tool.
N010 #MSG SYN["Y=%f Z=%f", V.A.ACT_POS.Y, V.A.ACT_POS.Z]
N020 V.G.WZ_AKT.L = 80
N030 #TRAFO ON
N040 #DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]
$IF V.E.AGAIN == 1
N050 #DIST CTRL ON [SURFACE SET_POS=0 MODE=ECS]
N060 #TIME 0.3
$ENDIF
N080 #DIST CTRL WAIT OFF
N090 #TIME 0.01
N110 #MSG SYN["Y=%f Z=%f", V.A.ACT_POS.Y, V.A.ACT_POS.Z]
N999 M30
