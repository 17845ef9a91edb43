%manual_7_5
; FCT-C4 7.5: axis 2 measures with the stamp of channel 2. The source is that of the list, or with V.E.BY_MEAS 1 of #MEAS.
N10 $IF V.E.BY_MEAS == 1
N12   #MEAS [ AXNR=2 SIGNAL=PLC_TIMESTAMP]
N14 $ENDIF
N20 G01 G90 Y70 F3000
N30 G100 Y90 F600
N40 #MSG SYN["V.A.MESS.Y=%f", V.A.MESS.Y]
N50 #MSG SYN["V.A.MERF.Y=%d", V.A.MERF.Y]
N60 M30
