%measuring_goes_on
; Type 3 with G106: the position is latched at the signal and the run goes on to its target.
N05 #MEAS MODE[3]
N10 G01 G90 Z110.374 F3000
N20 G100 G106 Z=V.E.TARGET F=V.E.FEED
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 #MSG SYN["V.A.ABS.Z=%f", V.A.ABS.Z]
N50 G01 Z120 F3000
N60 M30
