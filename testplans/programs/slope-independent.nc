%slope_independent
; X and Y move beside the path at the same feed, X with a jerk-limited slope and Y without ramps.
N10 X[INDP_SYN G01 G90 POS=30 FEED=4800 SLOPE_TYPE=SIN2] Y[INDP_SYN G01 G90 POS=30 FEED=4800]
N20 M30
