%independent
; X and Y measure at once, each with its own feed and latch; X measures again beside a run of the path.
N10 X[INDP_SYN G100 G90 POS100 FEED=V.E.FEED1] Y[INDP_SYN G100 G90 POS100 FEED=V.E.FEED2]
N20 G01 G90 X59 Y79 F3000
N30 X[INDP_ASYN G100 G90 POS=100 FEED=V.E.FEED2]
N40 G100 Z80 F=V.E.FEED1
N50 #WAIT INDP [X]
N60 M30
