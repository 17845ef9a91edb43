%probe_ball
; A probe with a ball, as in FCT-C4 section 5, under a zero offset of the rig
N10 #MEAS MODE[1]
N20 G54 D1
N30 G90 G1 X0 Y0 Z150 F3000
N40 G100 Z20 F300
N50 #MSG SYN["surface in the program %f", V.A.MEAS.PCS.VALUE.Z]
N60 #MSG SYN["centre of the ball on the axis %f", V.A.MEAS.ACS.VALUE.Z]
N70 #MSG SYN["to the target %f", V.A.MOFFS.Z]
N80 G1 Z150 F3000
N90 M30
