%approach_z
; One measurement run of Z from where it is at the start. Feed and target come from outside.
N20 G90 G100 Z=V.E.TARGET F=V.E.FEED
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N50 M30
