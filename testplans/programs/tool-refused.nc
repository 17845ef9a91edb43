%tool_refused
; A kinematic on a rig that may not have its axes
N10 #TRAFO [9]
N20 G00 G90 X10
N30 M30
