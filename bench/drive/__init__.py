"""The simulated DS402 drive: a CANopen slave in front of one axis of the plant.

`objects.csv` is its object dictionary, `eds.py` makes the EDS from it, `node.py` the slave;
`touch_probe.py`, `pdo.py` and `profile.py` are its parts. The axis and the wired probe signals
come in through the two protocols of `ports.py`.
"""
