"""The simulated DS402 drive: a CANopen slave that moves one axis of the plant.

`objects_communication.csv` and `objects_profile.csv` are its object dictionary, `eds.py` makes the
EDS from them, `node.py` is the slave. `communication` is what it does on the bus, `application`
what it does with its values; `profile.py` holds what differs from drive to drive. The axis and the
wired probe signals come in through the two protocols of `ports.py`.
"""
