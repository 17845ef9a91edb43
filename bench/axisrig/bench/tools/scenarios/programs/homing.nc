%homing
; The drive looks for its switch, then the program goes on in the coordinates of the reference.
N10 G74 Z1
N20 G01 G90 Z101 F1200
N30 M30
