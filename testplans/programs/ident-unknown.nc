%ident_unknown
; S-0-0104 is the gain of the position loop: the drive has no object for it
N010 #IDENT RD [AXNR 1 ID S-0-0092 P=P1 TYP 2 DEC 0 SERC]
N020 #IDENT RD [AXNR 1 ID S-0-0104 P=P2 TYP 2 DEC 2 SERC]
N030 M30
