%slope_path
; An oblique path, an arc and rapid traverse with ramps; then the slope of the list again.
N10 #SLOPE [TYPE=SIN2]
N20 G01 G90 X30 Y40 F3000
N30 G02 X70 Y40 I20 J0 F3000
N40 G00 X0 Y0
N50 #SLOPE DEFAULT
N60 M30
