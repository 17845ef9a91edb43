%homing
; the drive looks for its switch, then the program goes on in the coordinates of the reference
N10 G74 Z1
N20 #MSG SYN["N20 %f", V.A.ABS.Z]
N30 G1 Z110 F1200
N40 #PUT AX[Z]
N50 #CALL AX[Z,3,0]
N60 #CHANNEL INIT[CMDPOS]
N70 #MSG SYN["N70 %f", V.A.ABS.Z]
N80 M30
