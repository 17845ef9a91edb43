%stamp_of_before
; Two runs of Z; from the second one on the PLC writes the time stamp a cycle after the signal, so that
; the signal comes with the stamp of the first run.
N10 G01 G90 Z101 F3000
N20 G100 Z99 F600
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 V.E.STAMP_LATE = 1
N50 G01 Z100.1 F3000
N60 G100 Z99 F1200
N70 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N80 M30
