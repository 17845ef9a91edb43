%sources_by_meas
; The source is chosen in the program: FCT-C4 7.5, then 7.4 with another input and edge, then the list.
N10 #MEAS [AXNR=3 SIGNAL=PLC_TIMESTAMP]
N20 G01 G90 Z101 F3000
N30 G100 Z99 F600
N40 #MSG SYN["V.A.MESS.Z=%f", V.A.MESS.Z]
N50 #MEAS DEFAULT
N60 G01 Z101 F3000
N70 G100 Z99 F600
N80 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N90 G01 Z101 F3000
N100 M30
