%distance_3d_order
; Kinematic 9 on axes that are not X Y Z C A.
N010 V.G.WZ_AKT.L = 80
N020 #TRAFO [9]
N030 G01 X10 F600
N999 M30
