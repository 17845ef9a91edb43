%cost-five-axes
; What a cycle of 3D distance control costs: the tool leans and goes sideways while the control follows.
N10 V.G.WZ_AKT.L = 80
N20 #TRAFO ON
N30 G01 X0 Y0 Z0 F6000
N40 #DIST CTRL [SENSOR_SOURCE=VARIABLE SENSOR_VAR=V.E.SENSOR]
N50 #DIST CTRL ON [CONST_DIST SET_DIST=80 MODE=ECS]
N60 G01 X20 Y5 C30 A-30 F3000
N70 X0 Y0 C0 A-10
N80 #DIST CTRL WAIT [OFF]
N90 M30
