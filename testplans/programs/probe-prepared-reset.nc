%probe_prepared_reset
; A reset between #MEAS PREPARE and the run (plc:reset = at=M50): the probe is enabled at the start of
; the run as ever. Started again, the program is to prepare nothing: V.E.AGAIN is 1 then.
N10 #MSG SYN["again %d", V.E.AGAIN]
N20 $IF V.E.AGAIN == 0
N30   #MEAS PREPARE [AXNR=3]
N40   V.E.AGAIN = 1
N50   G04 1
N60   M50
N70   G04 1
N80 $ENDIF
N90 G01 G90 Z110 F3000
N100 G100 Z80 F600
N110 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N120 G01 Z120 F3000
N130 #MSG SYN["prepared %d", V.E.PREPARES]
N140 #MSG SYN["enabled %d", V.E.ENABLES]
N150 M30
