"""The CNC and the co-simulation master: NC language, motion, measuring, drive links, time.

The kernel sees the machine through the bus only and does not depend on test plans.
"""
