"""No drive moves on whose telegrams stay out, whatever it does by itself and whatever it hears.

In pre-operational a drive sends and hears no PDOs, but answers SDO (CiA 301). One that looks for
its reference, or has a set speed, would go on; so would one whose position loop the control closes
with a position that does not come any more.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

RunNc = Callable[..., Any]
LEADING = "N10 G01 G90 Z90 F600\nN20 M30"
HOMING = "N10 G74 Z1\nN20 M30"
SPEED_MM_S = {"probe-z-velocity.toml": 10.0, "homing-z-g74.toml": 20.0}
PRE_OPERATIONAL, STOPPED, UNSEEN = (
    "fault:reset=Z command=pre_operational", "fault:reset=Z command=stop", "fault:drop=Z.TPDO1",
)  # fmt: skip
STANDS_MM_S = 0.1
"""The bench looks on until a motor is slower for 20 ms (docs/faults.md)."""
CYCLES = 4 + 16
"""Until the alarm (`missing_cycles` + 1), and as long as an answer of a drive may take."""
A_MM_S2, KV_PER_S = 500.0, 10.0
"""The slowest that acts: 609A, the list of the axis has more; gain of both position loops."""


def way_mm(outcome: Any, begin_ns: float) -> float:
    """Return how far the load goes after an instant."""
    inside = outcome.column("time_ns") >= begin_ns
    return float(np.ptp(outcome.column("Z.truth_mm")[inside]))


@pytest.mark.parametrize("rig", SPEED_MM_S)
@pytest.mark.parametrize("fault", [PRE_OPERATIONAL, STOPPED, UNSEEN])
@pytest.mark.long(but=1)
def test_an_axis_stops_when_its_telegrams_stay_out(run_nc: RunNc, rig: str, fault: str) -> None:
    """The way: v until it is stopped, v^2/2a of the ramp, v/Kv that the axis lags behind."""
    outcome = run_nc(HOMING if "homing" in rig else LEADING, "", f"{fault} at=200ms", base=rig)
    v_mm_s = SPEED_MM_S[rig]
    assert outcome.alarms == [900006]
    assert abs(outcome.column("Z.velocity_mm_s")[-1]) < STANDS_MM_S
    allowed_mm = v_mm_s * CYCLES * 1e-3 + v_mm_s**2 / (2 * A_MM_S2) + v_mm_s / KV_PER_S
    assert way_mm(outcome, outcome.facts.start_ns + 200e6) < allowed_mm
