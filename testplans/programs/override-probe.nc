%override_probe
; One measurement run of Z from where the axis is, nothing else moves. The feed comes from outside
; (plan column plc:V.E.FEED); what the PLC side makes of it is the case.
N10 G100 G90 Z80 F=V.E.FEED
N20 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N30 M30
