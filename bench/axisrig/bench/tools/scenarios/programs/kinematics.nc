%kinematics
; A touch with the tool inclined, and the way back; C and A turn about the tool centre point first.
N05 D1
N10 #TRAFO [9]
N20 G01 G90 X0 Y0 Z=V.E.Z C=V.E.C A=V.E.A F3000
N40 G100 Z-3 F=V.E.FEED
N50 G01 Z=V.E.Z F3000
N60 #TRAFO OFF
N70 M30
