"""Prints a line for each of COUNT fault scenarios from FIRST: frames, judgement, alarms.

`python tests/compiled/scenario_hashes.py FIRST COUNT`, with the interpreter of either build.
"""

import sys

from axisrig.bench.tools.scenarios.campaign import examine
from axisrig.bench.tools.scenarios.scenario import make_scenario

SEED = 17

first, count = map(int, sys.argv[1:])
for number in range(first, first + count):
    judgement, machine = examine(make_scenario(SEED, number))
    frames = "" if machine is None else machine.hexdigest()
    print(number, frames, judgement.result, judgement.right, judgement.alarms, judgement.note)
