%stamps_wrap
; A run that arms its probe before the clock of the stamps (32 bits of ns) wraps after 4.295 s, and ends behind it
N10 G01 G90 Z110 F3000
N15 G04 3.3
N20 G100 Z105 F300
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 $IF V.A.MERF.Z == 1
N50 #MSG SYN["V.A.MESS.Z=%f", V.A.MESS.Z]
N60 #MSG SYN["V.A.MOFFS.Z=%f", V.A.MOFFS.Z]
N70 $ENDIF
N80 G01 Z120 F3000
N90 M30
