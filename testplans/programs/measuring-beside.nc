%measuring_beside
; X measures three times, the last two beside the program. From the start of a run there is no result
; of X; what the run gives is there as soon as it has ended, without #WAIT INDP.
N10 X[INDP_SYN G100 G90 POS=100 FEED=3000]
N20 #MSG SYN["X signalled=%d", V.A.MERF.X]
N30 G0 X40
N40 X[INDP_ASYN G100 G90 POS=50 FEED=600]
N50 #MSG SYN["X under way, signalled=%d", V.A.MERF.X]
N60 #FLUSH WAIT
N70 G04 2
N80 #MSG SYN["X met nothing, signalled=%d", V.A.MERF.X]
N90 X[INDP_ASYN G100 G90 POS=100 FEED=3000]
N100 $WHILE V.A.MERF.X == 0
N110 $ENDWHILE
N120 #MSG SYN["X at %f", V.A.MESS.X]
N130 #MSG SYN["X behind its target by %f", V.A.MOFFS.X]
N140 G0 X40
N150 X[INDP_ASYN G100 G90 POS=100 FEED=600]
N160 G101 X1
N170 M30
