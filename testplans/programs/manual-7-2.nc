%manual_7_2
; FCT-C4 7.2: the probe is prepared while the axis positions, then enabled by the run. Source, input and edge are
; those of the list, or with V.E.BY_MEAS 1 of #MEAS.
N10 $IF V.E.BY_MEAS == 1
N12   #MEAS [AXNR=3 SIGNAL=EXT_PROBE_WITH_DRIVE INPUT=2 EDGE=NEG]
N14 $ENDIF
N20 #MEAS PREPARE [AXNR = 3]
N25 G01 G90 Z104 F3000
N30 G100 Z98 F600
N35 G04 0.1
N40 #MSG SYN["V.A.MESS.Z=%f", V.A.MESS.Z]
N50 #MSG SYN["tasks %d", V.E.TASKS_Z]
N60 #MSG SYN["acknowledged %d", V.E.DONE_Z]
N70 #MSG SYN["input %d", V.E.INPUT_Z]
N80 #MSG SYN["falling edge %d", V.E.FALLING_Z]
N90 M30
