"""The tool of the moment in which an independent axis begins to measure counts."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.coordinates import OffsetTables, Tool, Tools

Run = Callable[..., Any]
TOUCHED_MM = {"X": 60.0, "Y": 80.0}
BALLS = Tools({n: Tool(radius_mm=float(n), valid=True) for n in (2, 3)})


@pytest.fixture
def machine(plane_machine: Any) -> Any:
    """Every independent run ends where its axis has touched."""

    class Machine(plane_machine):
        def execute(self) -> None:
            for order in self.queue:
                if isinstance(order, canon.IndependentMove):
                    self.acs_mm[order.axis] = self.latched[order.axis] = TOUCHED_MM[order.axis]
            super().execute()

    return Machine(dict.fromkeys(("X", "Y", "Z"), 0.0), None)


@pytest.mark.parametrize("counts", [True, False])
def test_the_ball_is_that_of_the_tool_of_the_run(run: Run, machine: Any, counts: bool) -> None:
    text = (
        "%t\nN10 D2\nN20 X[INDP_ASYN G100 G90 POS=100 FEED=500]\nN30 D3\n"
        "N40 Y[INDP_ASYN G100 G90 POS=100 FEED=500]\nN50 D0\nN60 #WAIT INDP ALL\n"
        '#MSG ["%g %g", V.A.MEAS.PCS.VALUE.X, V.A.MEAS.PCS.VALUE.Y]\nN70 M30\n'
    )
    tables = OffsetTables(tools=BALLS.copy(), ball_radius_counts=counts)
    (message,) = [c for c in run(text, machine, tables=tables) if isinstance(c, canon.Message)]
    assert message.text == ("62 83" if counts else "60 80")


@pytest.mark.parametrize(
    ("at_begin", "later", "found_mm"), [(0, 3, 60.0), (3, 0, 63.0), (2, 3, 62.0), (0, 0, 60.0)]
)
def test_a_tool_that_is_chosen_while_it_measures_does_not_count(
    run: Run, machine: Any, at_begin: int, later: int, found_mm: float
) -> None:
    """No ball (D0) is the ball of a run as well: a D during the run brings none."""
    text = (
        f"%t\nN10 D{at_begin}\nN20 X[INDP_ASYN G100 G90 POS=100 FEED=500]\nN30 D{later}\n"
        'N40 #WAIT INDP ALL\n#MSG ["%g", V.A.MEAS.PCS.VALUE.X]\nN50 M30\n'
    )
    tables = OffsetTables(tools=BALLS.copy(), ball_radius_counts=True)
    (message,) = [c for c in run(text, machine, tables=tables) if isinstance(c, canon.Message)]
    assert message.text == f"{found_mm:g}"
