%probe_z
; One measurement run of Z towards the workpiece. The feed comes from outside (plan column plc:V.E.FEED).
N10 G01 G90 Z110.3722 F3000
N20 G100 Z80 F=V.E.FEED
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 G01 Z120 F3000
N50 M30
