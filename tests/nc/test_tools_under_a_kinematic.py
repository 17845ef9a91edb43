"""What changes a tool while a kinematic is on is warned of with its name, and nothing else is."""

import pytest
from tests.nc.five_axes import ON, run5

from axisrig.kernel.nc.canon import Warn


@pytest.mark.parametrize(
    ("block", "is_warned"),
    [
        ("D0", True),
        ("V.G.WZ_AKT.L=70", True),
        ("V.G.WZ_AKT.R=2", True),
        ("V.G.WZ[3].L=70", False),
        ("V.G.WZ[3].R=2", False),
        ("V.G.WZ[3].OK=1", False),
        ("P1=V.G.WZ_AKT.L", False),
        ("T5", False),
    ],
)
@pytest.mark.parametrize("is_on", [True, False])
def test_900481_names_the_kinematic_that_has_taken_the_length(block, is_warned, is_on) -> None:
    commands = run5(f"{ON}{'' if is_on else '#TRAFO OFF'}\n{block}")
    found = [each.alarm for each in commands if isinstance(each, Warn)]
    wanted = [(900481, {"name": "9"})] if is_warned and is_on else []
    assert [(alarm.id, alarm.values) for alarm in found] == wanted
