%probe_prepared
; #MEAS PREPARE of Z (with V.E.BOTH 1 of X too), what may end it, then a run of Z. V.E.CAUSE: 0 nothing, 1 X is
; homed, 2 X leaves the channel and comes back, 3 M50, at which the PLC side resets, 4 the program ends,
; 5 the program ends with an alarm. Started again (V.E.AGAIN 1) nothing is prepared; with V.E.RUN 0 there is no run.
; The PLC program keeps the record of its tasks: 1 ENABLE, 2 DISABLE, 3 PREPARE.
N10 $IF V.E.AGAIN == 0
N20   V.E.AGAIN = 1
N30   #MEAS PREPARE [AXNR=3]
N40   $IF V.E.BOTH == 1
N50     #MEAS PREPARE [AXNR=1]
N60   $ENDIF
N70   G04 0.05
N80   $IF V.E.CAUSE == 1
N90     G74 X1
N100  $ENDIF
N110  $IF V.E.CAUSE == 2
N120    #PUT AX[X]
N130    #CALL AX[X,1,0]
N140  $ENDIF
N150  $IF V.E.CAUSE == 3
N160    M50
N170    G04 1
N180  $ENDIF
N190  $IF V.E.CAUSE == 4
N200    M30
N210  $ENDIF
N220  $IF V.E.CAUSE == 5
N230    #ERROR [ID=455 RC=2]
N240  $ENDIF
N250 $ENDIF
N260 G04 0.1
N270 #MSG SYN["tasks of Z %d", V.E.TASKS_Z]
N280 #MSG SYN["acknowledged %d", V.E.DONE_Z]
N290 #MSG SYN["tasks of X %d", V.E.TASKS_X]
N300 #MSG SYN["acknowledged %d", V.E.DONE_X]
N305 #MSG SYN["disabled while the channel was in ERROR %d", V.E.IN_ERROR]
N310 $IF V.E.RUN == 1
N320   G100 Z98 F600
N330   #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N340   G04 0.1
N350   #MSG SYN["tasks of Z %d", V.E.TASKS_Z]
N360   #MSG SYN["acknowledged %d", V.E.DONE_Z]
N370   #MSG SYN["input %d", V.E.INPUT_Z]
N380   #MSG SYN["falling edge %d", V.E.FALLING_Z]
N390 $ENDIF
N400 M30
