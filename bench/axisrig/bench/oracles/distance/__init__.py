"""Closed forms of axis-specific distance control, and a discrete model of its own.

`lists` reads the parameters as written, `filters` has delay and noise gain of each filter in closed
form, `smoothing` what a filter does to a loop, `loop` the characteristic polynomial of each mode,
`stability` the limits of kp, `following` the errors on ramps and sines, `limits` what clamps do,
`cycles` the dead cycles of a rig, `model` walks the whole loop cycle by cycle, `signs` says which
signs converge and `supervision` when an alarm is due. Nothing here comes from the kernel's own
control, filters or conversions.
"""
