%fixed_stop_beam
; X with its slave X2 to a fixed stop from where both are, with V.E.FEED and V.E.LIMIT as torque limit of both drives, in
; 0.1 % of the rated torque; their following error windows are off. The message says what was measured.
N010 #SET AX LINK[1, [X2=X,G,15,20]]
N020 #ENABLE AX LINK[1]
N030 #IDENT WR SYN [AXNR 1 ID S-0-0092 VAL=V.E.LIMIT TYP 2 DEC 0 SERC]
N040 #IDENT WR SYN [AXNR 4 ID S-0-0092 VAL=V.E.LIMIT TYP 2 DEC 0 SERC]
N120 G100 X=V.E.TARGET F=V.E.FEED
N126 #MSG SYN["X=%f", V.A.MESS.X]
N130 G01 X0 F1000
N140 M30
