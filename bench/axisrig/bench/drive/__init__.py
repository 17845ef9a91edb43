"""The simulated drive: it moves one axis of the plant as a control on its bus demands.

`axis` is what any drive does with its axis, whatever its words are. `cia402` is what the words of a
drive of CiA 402 mean: objects, states, modes, touch probe. `canopen` carries them: PDOs, SDO, SYNC,
emergencies; `canopen/node.py` is a whole drive on a bus. The axis and the wired probe signals come
in through the protocols of `axis/ports.py`.
"""
