%probe_cycles_chosen
; The cycles keep what the program has chosen: Y measures with the stamp of a terminal, which the list does not say, and
; the type is 3 afterwards as before.
N10 #MEAS [AX=Y SIGNAL=PLC_TIMESTAMP]
N12 #MEAS MODE[3]
N15 L CYCLE [NAME=probe_calibrate.cyc @P1=V.E.AXIS @P2=V.E.PLACE @P3=V.E.DFA @P4=V.E.DIR \
     @P5=V.E.TOUCHES @P6=V.E.FIELD @P7=V.E.CALFEED]
N20 L CYCLE [NAME=probe_measure.cyc @P1=V.E.AXIS @P2=V.E.SET @P3=V.E.DFA @P4=V.E.DIR \
     @P5=V.E.TOUCHES @P6=V.E.FIELD @P7=V.E.FEED]
N30 #MSG SYN ["value %.6f mm", V.P.OVR_VALUE]
N40 #MSG SYN ["difference %.6f mm", V.P.OVR_DIFF]
N50 #MSG SYN ["spread %.6f mm", V.P.OVR_SPREAD]
N60 #MSG SYN ["calibration %.6f mm", V.S.CAL_OFFSET[V.E.FIELD][V.E.AXIS][[V.E.DIR + 1] / 2]]
N70 #MSG SYN ["largest %.6f mm", V.P.OVR_MAX]
N80 #MSG SYN ["smallest %.6f mm", V.P.OVR_MIN]
N90 #MSG SYN ["set value %.6f mm", V.P.OVR_SET]
N100 #MSG SYN ["touches %d", V.P.OVR_COUNT]
N110 #MSG SYN ["type %d", V.G.MEAS_TYPE]
N120 M30
