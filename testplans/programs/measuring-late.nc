%measuring_late
; A run to V.E.TARGET whose edge comes about the instant at which the axis comes to rest there
N05 #MEAS MODE[V.E.TYPE]
N10 G01 G90 Z110 F3000
N20 G100 Z=V.E.TARGET F=V.E.FEED
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 $IF V.A.MERF.Z == 1
N50 #MSG SYN["V.A.MESS.Z=%f", V.A.MESS.Z]
N60 #MSG SYN["V.A.MOFFS.Z=%f", V.A.MOFFS.Z]
N70 $ENDIF
N80 G01 Z120 F3000
N90 M30
