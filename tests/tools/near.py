"""A touch near the surface in place of that of a row: a fifth of the time is simulated."""

from dataclasses import replace
from pathlib import Path

from axisrig.bench.plan.case import Case

PROGRAM = Path(__file__).parents[2] / "testplans" / "programs" / "touch-once.nc"
NEAR = {"plant:z.position_start_mm": "101.3", "plant:z.kv": "100", "plant:z.feed_forward": "1"}
"""A surface at 100 mm: 1.3 mm before it, and an axis that does not lag."""
BETWEEN_SYNCS = NEAR | {"plant:z.position_start_mm": "101.304"}
"""1.3 mm are whole cycles of 10 um: a contact at a SYNC, where a nanometre decides on a cycle."""


def near(case: Case) -> Case:
    """The touch of `touch-once.nc` between two SYNCs; checks of the row are not for it."""
    return replace(case, program=PROGRAM, inputs={**case.inputs, **BETWEEN_SYNCS}, checks=())
