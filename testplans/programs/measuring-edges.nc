%measuring_edges
; Both edges at both inputs of Z, one after the other, with one wiring: rising on the way down, where
; the probe touches; falling on the way up, where it gets free.
N05 #MEAS MODE[1]
N10 G01 G90 Z110 F3000
N20 G100 Z90 F=V.E.FEED
N30 #MSG SYN["input 1 rising %f", V.A.MESS.Z]
N40 G01 Z97 F3000
N50 #MEAS [AX=Z EDGE=NEG]
N60 G100 Z110 F=V.E.FEED
N70 #MSG SYN["input 1 falling %f", V.A.MESS.Z]
N80 G01 Z110 F3000
N90 #MEAS [AX=Z EDGE=POS INPUT=2]
N100 G100 Z90 F=V.E.FEED
N110 #MSG SYN["input 2 rising %f", V.A.MESS.Z]
N120 G01 Z97 F3000
N130 #MEAS [AX=Z EDGE=NEG INPUT=2]
N140 G100 Z110 F=V.E.FEED
N150 #MSG SYN["input 2 falling %f", V.A.MESS.Z]
N160 G01 Z120 F3000
N170 M30
