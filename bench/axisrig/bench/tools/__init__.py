"""Commands beside plans: virtual drive, FMUs, tuning, parameters, scenarios, speed, bus logs."""
