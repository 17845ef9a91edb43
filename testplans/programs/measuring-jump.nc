%measuring_jump
; Type 5: the signal ends the run and the program goes on at the label; without a signal nothing jumps.
N05 #MEAS MODE[5]
N10 G01 G90 Z110.374 F3000
N15 V.P.REACHED = 0
N20 G310 G01 Z=V.E.TARGET F=V.E.FEED $GOTO[TOUCHED]
N25 V.P.REACHED = 1
N28 [TOUCHED] #MSG SYN["reached its target=%d", V.P.REACHED]
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 #MSG SYN["V.A.PROG.Z=%f", V.A.PROG.Z]
N50 G01 Z120 F3000
N60 M30
