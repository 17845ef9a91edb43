%probe_cycles
; Calibrates the probe on a surface whose place is known (V.E.PLACE) and measures it again, expected at V.E.SET.
N10 L CYCLE [NAME=probe_calibrate.cyc @P1=V.E.AXIS @P2=V.E.PLACE @P3=V.E.DFA @P4=V.E.DIR \
     @P5=V.E.TOUCHES @P6=1 @P7=V.E.CALFEED]
N20 L CYCLE [NAME=probe_measure.cyc @P1=V.E.AXIS @P2=V.E.SET @P3=V.E.DFA @P4=V.E.DIR \
     @P5=V.E.TOUCHES @P6=V.E.FIELD @P7=V.E.FEED]
N30 #MSG SYN ["value %.6f mm", V.P.OVR_VALUE]
N40 #MSG SYN ["difference %.6f mm", V.P.OVR_DIFF]
N50 #MSG SYN ["spread %.6f mm", V.P.OVR_SPREAD]
N60 #MSG SYN ["calibration %.6f mm", V.S.CAL_OFFSET[1][V.E.AXIS][[V.E.DIR + 1] / 2]]
N70 M30
