"""Independent axes (INDP_SYN, INDP_ASYN) against fixed stops, each for itself, beside the path."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

Run = Callable[..., Any]
T_S, KV, LAG_MM, TAU_S = 1e-3, 40.0, 0.5, 0.1
PRESSED_MM = 0.1 * 2 * np.pi * 9.0 / 0.010 / 20e6 * 1e3  # 10 % of 9 N.m, 10 mm, 20 N/um
LIMITED = "\n".join(
    f"#IDENT WR SYN [AXNR {number} ID S-0-0092 VAL=100 TYP 2 DEC 0 SERC]\n"
    f"#IDENT WR SYN [AXNR {number} ID S-0-0159 VAL=0 TYP 4 DEC 0 SERC]"
    for number in (1, 2, 3)
)
STOPS = {"X": 130.0, "Y": 6.0, "Z": 4.0}
PLANTS = (
    "plant:x.position_start_mm=125",
    "plant:y.stop_position_mm=6",
    "plant:z.stop_position_mm=4",
)


@pytest.fixture
def axes(run_nc: Run) -> Callable[..., Any]:
    """Return `run(program, *assignments)`: X from 125, Y and Z from 0 mm."""

    def run(program: str, *assignments: str) -> Any:
        base = "fixed-stop-gantry.toml"
        return run_nc(f"{LIMITED}\n{program}", "", *PLANTS, *assignments, base=base)

    return run


def run_of(out: Any, *axes: str) -> Any:
    return next(record for record in out.machine.channel.records if record.axes == axes)


def contact_ns(out: Any, axis: str) -> float:
    """When the load of an axis has come to its stop, from its truth."""
    times, truth = out.column("time_ns"), out.column(f"{axis}.truth_mm")
    behind, place = int(np.argmax(truth > STOPS[axis])), STOPS[axis]
    share = (place - truth[behind - 1]) / (truth[behind] - truth[behind - 1])
    return float(times[behind - 1] + share * (times[behind] - times[behind - 1]))


def is_found_in_time(out: Any, axis: str, feed_mm_s: float) -> None:
    """Lag beyond L at t_c + (L - v/Kv + F/k)/v, found tau later, in whole cycles."""
    stop = run_of(out, axis).fixed_stop
    assert stop.detected_by == axis
    taken_s = (stop.detected_ns - contact_ns(out, axis)) * 1e-9
    wanted_s = (LAG_MM - feed_mm_s / KV + PRESSED_MM) / feed_mm_s + TAU_S
    assert 0 <= taken_s - wanted_s <= 2 * T_S


@pytest.mark.long
def test_each_axis_finds_its_own_stop(axes: Run) -> None:
    """Both at once, each with its own feed, detection and motion back to its own place."""
    out = axes(
        "X[INDP_SYN G100 G90 POS=200 FEED=600] Y[INDP_SYN G100 G90 POS=100 FEED=300]\n"
        '#MSG SYN["X=%f", V.A.MESS.X]\n#MSG SYN["Y=%f", V.A.MESS.Y]\n'
        '#MSG SYN["at=%f", V.A.ABS.X]\n#MSG SYN["merf=%d", V.A.MERF.Y]\n'
        "G1 X120 Y0 F1000"
    )
    assert out.alarms == []
    for axis, feed_mm_s in (("X", 10.0), ("Y", 5.0)):
        (measured,) = out.printed(axis)
        assert measured == pytest.approx(STOPS[axis] + PRESSED_MM, abs=0.001)
        is_found_in_time(out, axis, feed_mm_s)
    assert out.printed("at") == [pytest.approx(130.0 + PRESSED_MM, abs=0.001)]
    assert out.printed("merf") == [1]
    assert all(link.watches_lag for link in out.machine.channel.links)


@pytest.mark.long
def test_the_relaxing_motion_of_an_axis_has_its_feed(axes: Run) -> None:
    """v T from cycle to cycle, no faster than to the stop; rapid traverse would be."""
    out = axes("X[INDP_SYN G100 G90 POS=200 FEED=600]")
    stop = run_of(out, "X").fixed_stop
    times, sets_mm = out.column("time_ns"), out.column("X.set_mm")
    inside = (times >= stop.relax_begin_ns) & (times <= stop.relax_end_ns)
    assert np.diff(sets_mm[inside]).min() == pytest.approx(-10.0 * T_S, rel=1e-6)


@pytest.mark.long
def test_an_axis_runs_to_its_stop_beside_a_run_of_the_path(axes: Run) -> None:
    """The path is not asked about the other axis, nor the other way round."""
    out = axes(
        "X[INDP_ASYN G100 G90 POS=200 FEED=600]\nG100 Z100 F240\n"
        '#MSG SYN["Z=%f", V.A.MESS.Z]\n#WAIT INDP [X]\n#MSG SYN["X=%f", V.A.MESS.X]\n'
        "G1 X120 Z0 F1000"
    )
    assert out.alarms == []
    assert out.printed("Z") == [pytest.approx(4.0 + PRESSED_MM, abs=0.001)]
    assert out.printed("X") == [pytest.approx(130.0 + PRESSED_MM, abs=0.001)]
    is_found_in_time(out, "X", 10.0)
    is_found_in_time(out, "Z", 4.0)


MISSED = 'X[INDP_SYN G100 G90 POS=128 FEED=600]\n#MSG SYN["merf=%d", V.A.MERF.X]'


@pytest.mark.long
@pytest.mark.provokes(900240, 4, axes="X")
def test_900240_for_an_axis_that_finds_no_stop(axes: Run) -> None:
    out = axes(MISSED)
    assert out.alarms == [900240]
    assert "X lag > 0.5 mm" in str(out.machine.channel.alarms[0])
    assert all(link.watches_lag for link in out.machine.channel.links)


@pytest.mark.long
def test_without_a_stop_the_program_goes_on_by_p_chan_00266(axes: Run) -> None:
    out = axes(MISSED, "set:channel.meas_fixed_stop_no_error=1")
    assert out.alarms == []
    assert out.printed("merf") == [0]
    assert out.stand_mm("X") == pytest.approx(128.0, abs=0.01)


@pytest.mark.long
@pytest.mark.provokes(51026, 2, axis="X", value_permille=1001, limit_permille=1000)
def test_51026_for_an_axis_beside_the_path(axes: Run) -> None:
    wrong = "set:X.kenngr.measure.fixed_stop_detect.start_distance_per_mille=1001"
    assert axes(MISSED, wrong).alarms == [110757, 51026]


@pytest.mark.long
@pytest.mark.provokes(900241, 2, axis="X")
def test_900241_for_an_axis_whose_signal_is_no_stop(axes: Run) -> None:
    assert axes(MISSED, "set:X.kenngr.measure.signal=DRIVE").alarms == [900241]
