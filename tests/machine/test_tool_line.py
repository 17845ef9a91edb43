"""The line of the tool centre point is judged by when axes are there, not by P-AXIS-00191."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.bench.judge.topics import observe
from axisrig.bench.plan.checks import parse_check

LINE = "N10 #TRAFO [9]\nN20 G0 X0 Y0 Z10 C0 A0\nN30 G1 X2 Y1 Z11 C30 A-20 F600"
DELAYS = [f"set:{axis}.antr.nbr_delay_cycles=6" for axis in "XYZCA"]


@pytest.mark.parametrize("delays", [DELAYS, pytest.param([], marks=pytest.mark.long)])
@pytest.mark.long
def test_what_the_cnc_assumes_of_its_dead_cycles_moves_no_tool(
    run_nc: Callable[..., Any], delays: list[str]
) -> None:
    """Increments of five axes leave 0.05 um; 4 cycles more are 40 um on a path that bends by C."""
    observed = run_nc(LINE, "", *delays, base="probe-5axis.toml").observed
    found = observe(observed, parse_check("tcp_from_line_um_max", "<= 1", "here"))
    assert isinstance(found.value, float)
    assert found.value < 0.1
