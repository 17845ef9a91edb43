"""A path of two axes on real plants: the first stop ends the run, each axis has its own place."""

import numpy as np
import pytest
from tests.machine.conftest import RunNc

RATED_N, LIMIT, STIFFNESS_N_UM = 2.2 * 2 * np.pi / 0.01, 0.4, 20.0
RIG = '[drive.servo]\nsdo = [["0x6072:0", 400]]\n'
PROGRAM = """\
N10 G90 G1 X10 Y10 F3000
N20 #MEAS MODE[7]
N30 G100 X60 Y40 F600
N40 #MSG SYN["X=%.9f", V.A.MESS.X]
N50 #MSG SYN["Y=%.9f", V.A.MESS.Y]
N60 G1 X10 Y10 F3000
"""


@pytest.mark.parametrize(("stops", "first"), [({"x": 30.0}, "X"), ({"y": 25.0}, "Y")])
@pytest.mark.long
def test_one_axis_hits_while_the_other_is_free(
    run_nc: RunNc, stops: dict[str, float], first: str
) -> None:
    detect = "kenngr.measure.fixed_stop_detect"
    settings = [f"plant:{plant}.stop_position_mm={mm}" for plant, mm in stops.items()]
    for axis in "XY":
        settings += [
            f"set:{axis}.kenngr.measure.signal=FIXED_STOP",
            f"set:{axis}.{detect}.pos_lag_limit=15000",
            f"set:{axis}.{detect}.min_time=150000",
            f"set:{axis}.getriebe[0].window=100",
        ]
        settings += [
            f"plant:{axis.lower()}.{part}_friction_n=0" for part in ("coulomb", "breakaway")
        ]
    outcome = run_nc(PROGRAM, RIG, *settings)
    assert outcome.alarms == []
    (record,) = outcome.machine.channel.records
    stop = record.fixed_stop
    assert stop is not None
    assert stop.detected_by == first
    delta_mm = LIMIT * RATED_N / STIFFNESS_N_UM / 1e3
    (stop_mm,) = stops.values()
    assert record.latched_mm[first] == pytest.approx(stop_mm + delta_mm, abs=1e-3)
    # The free axis: where it truly was at the SYNC of the detection, and there again at the end
    (free,) = {"X", "Y"} - {first}
    times, truth = outcome.column("time_ns"), outcome.column(f"{free}.truth_mm")
    assert stop.detected_ns is not None
    row = np.searchsorted(times, stop.detected_ns) - 1
    assert record.latched_mm[free] == pytest.approx(truth[row], abs=2e-5)
    assert outcome.stand_mm(free) == pytest.approx(record.latched_mm[free], abs=0.01)
