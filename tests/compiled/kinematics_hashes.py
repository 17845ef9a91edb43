"""Prints the hash of seeded poses, forward and back, for each machine of tests/kinematics.

`python tests/compiled/kinematics_hashes.py COUNT`, with the interpreter of either build.
"""

import hashlib
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.kinematics.machines import MACHINES

for name, machine in MACHINES.items():
    kinematic = machine.kernel()
    digest = hashlib.sha256()
    for row in machine.axes(int(sys.argv[1]), seed=10).tolist():
        tool = kinematic.forward(tuple(row))
        near = tuple(value + 0.5 for value in row)
        found = kinematic.inverse(tool, near), kinematic.direction(tool), kinematic.clamp_mm(tool)
        digest.update(repr((tool, found)).encode())
    print(name, digest.hexdigest())
