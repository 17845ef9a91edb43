%Independent_measurement_path
; FCT-C4 section 2: X and Y measure at once, each with its own feed and its own latch
N10 G0 X0 Y0
N20 X[INDP_SYN G100 G90 POS100 FEED500] \
        Y[INDP_SYN G100 G90 POS100 FEED1000]
N30 #MSG SYN["N30 %f", V.A.MESS.X]
N31 #MSG SYN["N31 %f", V.A.MESS.Y]
N32 #MSG SYN["N32 %d", V.A.MERF.X]
; the same beside the program: Z measures on the path meanwhile
N40 G0 X0 Y0
N50 X[INDP_ASYN G100 G90 POS=100 FEED=1200]
N60 G100 Z80 F1500
N70 #MSG SYN["N70 %f", V.A.MESS.Z]
N80 #WAIT INDP [X]
N90 #MSG SYN["N90 %f", V.A.MESS.X]
N100 M30
