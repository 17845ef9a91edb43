%measuring_twice
; Two runs without an alarm for a missing signal (P-CHAN-00176 = 0). The second one meets nothing and
; leaves nothing of the first: N80 is refused.
N05 #MEAS MODE[1]
N10 G01 G90 Z110 F3000
N20 G100 Z80 F600
N30 #MSG SYN["first run, V.A.MERF.Z=%d", V.A.MERF.Z]
N40 #MSG SYN["first run, V.A.MESS.Z=%f", V.A.MESS.Z]
N50 G01 Z110 F3000
N60 G100 Z105 F600
N70 #MSG SYN["second run, V.A.MERF.Z=%d", V.A.MERF.Z]
N80 #MSG SYN["second run, V.A.MESS.Z=%f", V.A.MESS.Z]
N90 M30
