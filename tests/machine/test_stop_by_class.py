"""A stop of class 7 on the real plants: the faulty axis leaves the path, its loop stays closed.

X and Y run at 45 degrees with 50 mm/s when the status telegrams of X stay out (900006); X goes on
to follow its set positions. Closed forms: v^2 / 2a with v = 50 / sqrt 2 mm/s, P-AXIS-00003 of X 500
and, P-CHAN-00097 being 0, the feed deceleration of both 800 mm/s^2 (P-AXIS-00011).
"""

import math
from typing import Any

import numpy as np
import pytest

from axisrig.kernel.drives.power import Power

V_MM_S = 50.0 / math.sqrt(2.0)
FAULT = "fault:drop=X.TPDO1 at=motion+400ms"
EMERGENCY = "set:X.getriebe[0].dynamik.a_emergency=500"


def way_mm(outcome: Any, axis: str) -> float:
    """From the last set position at full speed to the end.

    A row of the trace has the time of its SYNC, so the last one before the alarm is that of its
    cycle, which brakes already.
    """
    alarm_ns = outcome.machine.channel.alarm_ns[0]
    values = outcome.column(f"{axis}.set_mm")
    braking = int(np.searchsorted(outcome.column("time_ns"), alarm_ns)) - 1
    return float(values[-1] - values[braking - 1])


@pytest.mark.parametrize(
    ("settings", "x_mm"),
    [
        ([], V_MM_S**2 / 1600.0),
        ([EMERGENCY], V_MM_S**2 / 1000.0),
        (["set:X.getriebe[0].dynamik.a_max=400"], V_MM_S**2 / 800.0),
    ],
    ids=["own feedhold", "P-AXIS-00003", "P-AXIS-00008"],
)
@pytest.mark.long(but=1)
def test_the_faulty_axis_brakes_by_its_own_ramp(
    run_nc: Any, settings: list[str], x_mm: float
) -> None:
    outcome = run_nc("G1 X50 Y50 F3000", "", *settings, FAULT)
    assert outcome.alarms == [900006]
    assert way_mm(outcome, "X") == pytest.approx(x_mm, abs=1e-9)
    assert way_mm(outcome, "Y") == pytest.approx(V_MM_S**2 / 1600.0, abs=1e-9)
    end_mm = outcome.column("X.set_mm")[-1]
    assert outcome.column("X.truth_mm")[-1] == pytest.approx(end_mm, abs=0.01)
    links = outcome.machine.channel.links
    assert all(link.power is Power.OPERATING and link.keeps_operating for link in links)


@pytest.mark.long
def test_p_chan_00218_takes_every_axis_off_the_path(run_nc: Any) -> None:
    every = ["set:channel.independent_axis_error_stop=1", EMERGENCY]
    y = "set:Y.getriebe[0].dynamik.a_emergency=1000"
    outcome = run_nc("G1 X50 Y50 F3000", "", *every, y, FAULT)
    assert way_mm(outcome, "X") == pytest.approx(V_MM_S**2 / 1000.0, abs=1e-9)
    assert way_mm(outcome, "Y") == pytest.approx(V_MM_S**2 / 2000.0, abs=1e-9)
