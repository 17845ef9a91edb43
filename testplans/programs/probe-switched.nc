%probe_switched
; Two runs with a probe that the PLC switches, prepared before the first while the axis moves. The PLC
; program counts its tasks in V.E.PREPARES, V.E.ENABLES and V.E.DISABLES.
N10 #MEAS PREPARE [AXNR=3]
N20 G01 G90 Z120 F1000
N30 G100 Z80 F600
N40 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N50 G01 Z110 F3000
N60 G100 Z80 F600
N70 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N80 G01 Z120 F3000
N90 #WAIT FOR V.E.DISABLES == 2
N100 #MSG SYN["prepared %d", V.E.PREPARES]
N110 #MSG SYN["enabled %d", V.E.ENABLES]
N120 #MSG SYN["disabled %d", V.E.DISABLES]
N130 M30
