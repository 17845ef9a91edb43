%gantry
; X2 follows X from where both are; Z measures while they are coupled and after that.
N10 #SET AX LINK[1, [X2=X,G,15,20]]
N20 #ENABLE AX LINK[1]
N30 G90 G01 X=V.E.X F3000
N40 G100 Z80 F=V.E.FEED
N50 #DISABLE AX LINK[1]
N60 G01 Z101 F3000
N70 G01 X=V.E.X+1 F3000
N80 M30
