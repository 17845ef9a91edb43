%probe_z_idents
; A measurement run of Z, then what the drive itself has of it: the idents of the measured values, of the done
; measurements, and the position, over the service channel.
N10 G01 G90 Z=V.E.FROM F3000
N20 G100 Z=V.E.TO F=V.E.FEED
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 #IDENT RD [AX=Z ID=S-0-0130 P=P130 TYP=4 DEC=0 SERC]
N45 #IDENT RD [AX=Z ID=S-0-0131 P=P131 TYP=4 DEC=0 SERC]
N50 #IDENT RD [AX=Z ID=S-0-0179 P=P179 TYP=2 DEC=0 SERC]
N60 #MSG SYN["S-0-0130=%d", P130]
N70 #MSG SYN["S-0-0131=%d", P131]
N80 #MSG SYN["S-0-0179=%d", P179]
N90 M30
