"""Runs to a fixed stop beside their oracle: of a finished run, marks, values and metrics.

`truth` reads the plant's own signals, `rows` cuts out what belongs to one run, `run` puts the
closed forms of `oracles/fixed_stop` beside it, `values` and `findings` make what the report
shows, `metrics` what a plan checks.
"""
