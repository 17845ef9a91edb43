%scenario
; Two measurement runs of one place at two feeds: with 0.5 ms of input delay the value of the first
; is wrong for the second by micrometres.
N10 G90
N20 G100 Z-1 F=V.E.FEED1
N30 #MSG SYN["first %f", V.A.MEAS.ACS.VALUE.Z]
N40 G01 Z=V.E.RETRACT F=V.E.FEED1
N50 G100 Z-1 F=V.E.FEED2
N60 #MSG SYN["second %f", V.A.MEAS.ACS.VALUE.Z]
N70 G01 Z=V.E.RETRACT F=V.E.FEED1
N80 M30
