%fixed_stop_sercos
; To a fixed stop with the torque limited, away from it, and the same limits as before, by idents of the drive.
N10 #MEAS MODE[7]
N20 #IDENT WR SYN [AX=Z ID=S-0-0092 VAL=V.E.LIMIT TYP=2 DEC=0 SERC]
N30 #IDENT WR SYN [AX=Z ID=S-0-0159 VAL=0 TYP=4 DEC=0 SERC]
N40 G90 G100 Z120 F=V.E.FEED
N50 G91 G01 Z-0.5 F1000
N60 #IDENT WR SYN [AX=Z ID=S-0-0159 VAL=1048575 TYP=4 DEC=0 SERC]
N70 #IDENT WR SYN [AX=Z ID=S-0-0092 VAL=10000 TYP=2 DEC=0 SERC]
N80 M30
