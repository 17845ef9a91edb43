"""A gantry with a stiff beam against fixed stops: the beam turns freely, each stop takes one motor.

F torque limit, k of the stops, k_c of the couplings between motor and beam, v feed, L lag limit.
A side at its stop lags v/Kv + v (t - t_contact) - F/k - F/k_c behind its set position; the other
one goes on as if nothing had happened. Both sides begin at 0 mm.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

Run = Callable[..., Any]
T_S, STOP_MM, FEED_MM_S, WINDOW_MM = 1e-3, 2.0, 10.0, 0.01
LIMIT_N = 0.1 * 2 * np.pi * 9.0 / 0.010  # 10 % of 9 N.m on a screw of 10 mm
AHEAD_MM = LIMIT_N * (1 / 20e6 + 1 / 150e6) * 1e3
VISCOUS_N = 800 * FEED_MM_S * 1e-3  # friction of a guideway that slides
SLAVES_TOO = "set:X.kenngr.measure.fixed_stop_detect.use_gantry_slave=1"
PROGRAM = """\
N10 #SET AX LINK[1, [X2=X,G,1.5,20]]
N20 #ENABLE AX LINK[1]
N30 #IDENT WR SYN [AXNR 1 ID S-0-0092 VAL=100 TYP 2 DEC 0 SERC]
N40 #IDENT WR SYN [AXNR 4 ID S-0-0092 VAL=100 TYP 2 DEC 0 SERC]
N50 G100 X20 F600
N60 #MSG SYN["X=%f", V.A.MESS.X]
N70 G1 X0 F1000
"""


@pytest.fixture
def beam(run_nc: Run) -> Callable[..., Any]:
    """Return `run(*assignments)`: stops of both ends at 2 mm; the sides may part by 1.5 mm."""

    def run(*assignments: str) -> Any:
        return run_nc(PROGRAM, "", *assignments, base="fixed-stop-beam.toml")

    return run


def without(side: int) -> str:
    return f"plant:x.stop_position_{side}_mm=1000000"


def contact_ns(out: Any, axis: str) -> float:
    """When an end of the beam has come to its stop, from its truth."""
    times, truth = out.column("time_ns"), out.column(f"{axis}.truth_mm")
    behind = int(np.argmax(truth > STOP_MM))
    share = (STOP_MM - truth[behind - 1]) / (truth[behind] - truth[behind - 1])
    return float(times[behind - 1] + share * (times[behind] - times[behind - 1]))


def at_detection(out: Any, name: str) -> float:
    (record,) = out.machine.channel.records
    row = int(np.searchsorted(out.column("time_ns"), record.signal_ns, side="right")) - 1
    return float(out.column(name)[row])


@pytest.mark.long
def test_at_two_stops_each_takes_the_limit_of_its_motor(beam: Run) -> None:
    out = beam()
    assert out.alarms == []
    assert out.printed("X") == [pytest.approx(STOP_MM + AHEAD_MM, abs=0.001)]
    for axis in ("X", "X2"):
        assert at_detection(out, f"{axis}.stop_force_n") == pytest.approx(LIMIT_N, rel=0.002)
    skew = out.column("X.truth_mm") - out.column("X2.truth_mm")
    assert np.abs(skew).max() < 1e-6


@pytest.mark.long
def test_at_the_stop_of_the_master_the_beam_turns_about_it(beam: Run) -> None:
    """One motor presses, not both: at the free end no force is left but that of the guideway."""
    out = beam(without(2))
    assert out.alarms == []
    assert out.printed("X") == [pytest.approx(STOP_MM + AHEAD_MM, abs=0.001)]
    assert at_detection(out, "X.stop_force_n") == pytest.approx(LIMIT_N, rel=0.002)
    assert at_detection(out, "X2.force_n") == pytest.approx(VISCOUS_N, abs=5.0)
    (record,) = out.machine.channel.records
    taken_s = (record.signal_ns - contact_ns(out, "X")) * 1e-9
    skew_mm = at_detection(out, "X2.truth_mm") - at_detection(out, "X.truth_mm")
    skewed_mm = FEED_MM_S * taken_s - LIMIT_N / 20e6 * 1e3
    assert skew_mm == pytest.approx(skewed_mm, abs=FEED_MM_S * T_S)
    # led back beside its master: straight again to the exact-stop window
    assert out.stand_mm("X2") == pytest.approx(STOP_MM + AHEAD_MM, abs=WINDOW_MM)


@pytest.mark.long
def test_nothing_of_the_slaves_stop_comes_to_the_master(beam: Run) -> None:
    """Unwatched, the first limit of the coupling ends the run at t_c + (l1 + F/k + F/k_c)/v."""
    out = beam(without(1))
    assert out.alarms == [900192]
    (alarm_ns,) = out.machine.channel.alarm_ns
    predicted_s = (1.5 + AHEAD_MM) / FEED_MM_S
    taken_s = (alarm_ns - contact_ns(out, "X2")) * 1e-9
    assert 0 <= taken_s - predicted_s <= 2 * T_S
    before = out.column("time_ns") < alarm_ns - 10_000_000
    assert out.column("X2.stop_force_n")[before][-1] == pytest.approx(LIMIT_N, rel=0.002)
    assert out.column("X.force_n")[before][-1] == pytest.approx(VISCOUS_N, abs=5.0)


@pytest.mark.long
def test_with_p_axis_00835_the_slave_is_found_before_the_limit(beam: Run) -> None:
    out = beam(without(1), SLAVES_TOO)
    assert out.alarms == []
    (record,) = out.machine.channel.records
    assert record.fixed_stop.detected_by == "X2"
    taken_s = (record.signal_ns - contact_ns(out, "X2")) * 1e-9
    predicted_s = (0.5 - FEED_MM_S / 40 + AHEAD_MM) / FEED_MM_S + 0.1
    assert 0 <= taken_s - predicted_s <= 2 * T_S
    (measured,) = out.printed("X")
    assert measured == pytest.approx(STOP_MM + FEED_MM_S * taken_s, abs=FEED_MM_S * 2 * T_S)
