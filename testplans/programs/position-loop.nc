%position_loop
; One measurement run of Z towards the workpiece from V.E.FROM on, all with the feed V.E.FEED, so that the lag of the
; run has settled before the contact.
N10 G01 G90 Z=V.E.FROM F=V.E.FEED
N20 G100 Z80 F=V.E.FEED
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 G01 Z=V.E.FROM F=V.E.FEED
N50 M30
