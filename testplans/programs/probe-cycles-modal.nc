%probe_cycles_modal
; Calibrates in mm and measures in inch, with the ball of tool 1 and a DFA below its radius; the caller goes on in G70,
; G91 and its own feed.
N05 D1
N10 L CYCLE [NAME=probe_calibrate.cyc @P1=V.E.AXIS @P2=V.E.PLACE @P3=V.E.DFA @P4=V.E.DIR \
     @P5=V.E.TOUCHES @P6=1 @P7=V.E.CALFEED]
N15 G70 G91 G01 F50
N20 L CYCLE [NAME=probe_measure.cyc @P1=V.E.AXIS @P2=V.E.SET/25.4 @P3=V.E.DFA/25.4 @P4=V.E.DIR \
     @P5=V.E.TOUCHES @P6=V.E.FIELD @P7=V.E.FEED/25.4]
N25 Z0.5
N30 #MSG SYN ["value %.6f mm", V.P.OVR_VALUE]
N40 #MSG SYN ["difference %.6f mm", V.P.OVR_DIFF]
N50 #MSG SYN ["spread %.6f mm", V.P.OVR_SPREAD]
N60 #MSG SYN ["calibration %.6f mm", V.S.CAL_OFFSET[1][V.E.AXIS][[V.E.DIR + 1] / 2]]
N70 #MSG SYN ["half an inch above where the touch began: %.6f inch", V.A.ABS.Z]
N80 #MSG SYN ["feed %.6f inch/min", V.G.FEEDRATE]
N90 M30
