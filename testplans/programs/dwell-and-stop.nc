%dwell_and_stop
; Nothing moves: dwell times, a programmed stop (plc:start_ms), functions for the PLC side.
N10 M8 T3
N20 G04 X0.25
N30 G04 0.25
N40 #TIME 0.5
N50 M00
N60 M01
N70 #MSG SYN["V.A.ABS.X=%f", V.A.ABS.X]
N80 M30
