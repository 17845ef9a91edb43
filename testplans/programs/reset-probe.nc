%reset_probe
; A measurement run of Z after a positioning; the PLC side resets it and starts it again.
; What it finds is printed first.
N10 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N20 #MSG SYN["V.A.ACT_POS.Z=%f", V.A.ACT_POS.Z]
N30 G1 G90 Z120 F3000
N40 G100 Z80 F=V.E.FEED
N50 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N60 #MSG SYN["V.A.MESS.Z=%f", V.A.MESS.Z]
N70 G1 Z120 F3000
N80 M30
