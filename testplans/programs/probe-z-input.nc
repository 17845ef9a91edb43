%probe_z_input
; A measurement run of Z with the input and edge that the telegram leaves; then input 2, which a SERCOS drive does
; not change by the program.
N10 G01 G90 Z110.374 F3000
N20 G100 Z80 F=V.E.FEED
N30 #IDENT RD [AX=Z ID=S-0-0131 P=P131 TYP=4 DEC=0 SERC]
N40 #MSG SYN["S-0-0131=%d", P131]
N50 #MEAS [AX=Z INPUT=2]
N60 M30
