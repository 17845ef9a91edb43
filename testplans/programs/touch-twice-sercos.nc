%touch_twice_sercos
; Two touches of the same place with what the drive has of each.
N05 G01 G90 Z110.374 F3000
N10 G100 Z98 F=V.E.FEED
N20 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N30 #IDENT RD [AX=Z ID=S-0-0130 P=P130 TYP=4 DEC=0 SERC]
N40 #MSG SYN["S-0-0130=%d", P130]
N50 G01 Z110 F3000
N60 G100 Z98 F=V.E.FEED
N70 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N80 M30
