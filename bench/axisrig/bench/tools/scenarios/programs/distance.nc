%distance
; Constant distance, held, then by the surface, and off: the offset goes back.
N10 Z[DIST_CTRL ON CONST_DIST SET_DIST=V.E.DIST]
N20 G04 0.12
N30 Z[DIST_CTRL FREEZE]
N40 G04 0.03
N50 Z[DIST_CTRL ON SET_POS=30]
N60 G04 0.1
N70 Z[DIST_CTRL OFF]
N80 G01 G90 Z33 F600
N90 M30
