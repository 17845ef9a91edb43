"""Closed forms of a measurement run to a fixed stop (measuring type 7).

`lists` reads the criteria from the parameter lists as written and `slopes` the ramps, `contact`
finds the contact in the plant's truth, `pressing` says how axis and stop press, `timing` when the
criteria hold, `following` walks the criteria along the plant's own motion, `false_triggers`
computes where a stop is found in free motion. Nothing here comes from the kernel's own reading of
lists, criteria or instants.
"""
