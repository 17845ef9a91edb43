%cost-three-axes
; The same way as cost-five-axes.nc, with three axes.
N10 G01 X0 Y0 F6000
N20 X20 Y5 Z110 F3000
N30 X0 Y0 Z120
N40 M30
