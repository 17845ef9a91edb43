%contouring
; A measuring block may not be rounded: polynomial contouring is on, and the run is refused.
N10 G01 G90 Z120 F3000
N20 G261
N30 Z110
N40 G100 Z80 F300
N50 M30
