"""Independent axes, a gantry and homing on the real plants, against closed forms.

v feed, a = 1000 mm/s2 of every ramp, Kv = 40 1/s, T = 1 ms, U the wait of a latch for its SYNC. A
run ends v (U + T) + v^2/2a + v/Kv behind its contact (docs/architecture.md); without dry friction.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from axisrig.kernel.errors import Alarm

Run = Callable[..., Any]
PLANS = Path(__file__).parents[2] / "testplans"
INCREMENT_MM = 10 / 2**20
A_MM_S2, KV, T_S, S = 1000.0, 40.0, 1e-3, 1_000_000_000
CONTACT_MM = {"X": 60.0, "Y": 80.0}
SMOOTH = "\n".join(
    f"[plant.{axis}]\nstart = {{ coulomb_friction_n = 0, breakaway_friction_n = 0 }}"
    for axis in "xyz"
)


def edge_ns(out: Any, axis: str) -> int:
    """When the probe of an axis is met first."""
    signal = out.machine.plant.probes[f"stop_{axis.lower()}"].signal
    return int(next(time_ns for time_ns, level in signal.edges if level))


def end_mm(out: Any, axis: str) -> float:
    """Where the load stands in the end."""
    return float(out.column(f"{axis}.truth_mm")[-1])


def run_of(out: Any, axis: str) -> Any:
    return next(record for record in out.machine.channel.records if record.axes == (axis,))


@pytest.mark.long
@pytest.mark.parametrize(("feed_x", "feed_y"), [(500, 1000), (2000, 4000)])
def test_each_axis_measures_and_stops_for_itself(run_nc: Run, feed_x: int, feed_y: int) -> None:
    """FCT-C4 section 2, %Independent_measurement_path."""
    out = run_nc(
        "N10 G0 X0 Y0\n"
        f"N20 X[INDP_SYN G100 G90 POS100 FEED{feed_x}] \\\n"
        f"        Y[INDP_SYN G100 G90 POS100 FEED{feed_y}]\n"
        '#MSG SYN["X=%f", V.A.MESS.X]\n#MSG SYN["Y=%f", V.A.MESS.Y]\n'
        '#MSG SYN["off=%f", V.A.MOFFS.X]\n#MSG SYN["merf=%d", V.A.MERF.Y]',
        SMOOTH,
        *(f"set:{axis}.getriebe[0].window=1" for axis in "XY"),
        base="independent-xy.toml",
    )
    assert out.alarms == []
    for axis, feed in (("X", feed_x), ("Y", feed_y)):
        (measured,) = out.printed(axis)
        assert measured == pytest.approx(CONTACT_MM[axis], abs=INCREMENT_MM)
        v, record = feed / 60.0, run_of(out, axis)
        waited_s = out.waited_s(edge_ns(out, axis))
        behind_mm = v * (waited_s + T_S) + v * v / (2 * A_MM_S2) + v / KV
        assert end_mm(out, axis) - CONTACT_MM[axis] == pytest.approx(behind_mm, abs=0.0003)
        # contact: the demand is the lag ahead and has lost v/2a while it sped up
        travel_s = (CONTACT_MM[axis] + v / KV) / v + v / (2 * A_MM_S2)
        assert edge_ns(out, axis) - record.start_ns == pytest.approx(travel_s * S, abs=2 * T_S * S)
    assert out.printed("off") == [pytest.approx(-40.0, abs=INCREMENT_MM)]
    assert out.printed("merf") == [1.0]


@pytest.mark.long
def test_an_axis_measures_beside_a_run_of_the_path(run_nc: Run) -> None:
    out = run_nc(
        "N10 X[INDP_ASYN G100 G90 POS=100 FEED=600]\n"
        "N20 G100 Z80 F6000\n"
        '#MSG SYN["Z=%f", V.A.MESS.Z]\n'
        "N30 G1 Z120 F6000\n"
        "N40 #WAIT INDP [X]\n"
        '#MSG SYN["X=%f", V.A.MESS.X]',
        "",
        base="independent-xy.toml",
    )
    assert out.alarms == []
    assert out.printed("Z") == [pytest.approx(100.0, abs=INCREMENT_MM)]
    assert out.printed("X") == [pytest.approx(60.0, abs=INCREMENT_MM)]
    path, alone = run_of(out, "Z"), run_of(out, "X")
    assert alone.start_ns < path.signal_ns < path.end_ns < alone.signal_ns


@pytest.mark.long
def test_a_run_beside_the_program_leaves_nothing_of_the_one_before(run_nc: Run) -> None:
    """The stop is at 60 mm: the second run ends before it, the third meets it again."""
    ask = '#MSG SYN["{}=%d", V.A.MERF.X]\n'
    out = run_nc(
        "N10 X[INDP_SYN G100 G90 POS=100 FEED=3000]\n"
        + ask.format("first")
        + "N20 G0 X40\nN30 X[INDP_ASYN G100 G90 POS=50 FEED=3000]\n"
        + ask.format("under way")
        + "N40 #FLUSH WAIT\nN50 G4 2\n"
        + ask.format("without")
        + "N60 X[INDP_ASYN G100 G90 POS=100 FEED=3000]\nP1 = 0\n"
        "N70 $WHILE V.A.MERF.X == 0\nP1 = P1 + 1\n$ENDWHILE\n"
        + ask.format("third")
        + '#MSG SYN["X=%f", V.A.MESS.X]\n#MSG SYN["asked=%d", P1]\n'
        "N80 G0 X40\nN90 X[INDP_ASYN G100 G90 POS=50 FEED=3000]\nN100 G4 2\n"
        '#MSG SYN["X=%f", V.A.MESS.X]',
        "",
        base="independent-xy.toml",
    )
    found = [out.printed(name)[0] for name in ("first", "under way", "without", "third")]
    assert found == [1.0, 0.0, 0.0, 1.0]
    assert out.printed("X") == [pytest.approx(60.0, abs=INCREMENT_MM)]
    assert out.alarms == [900101]
    run = [record for record in out.machine.channel.records if record.axes == ("X",)][2]
    # every cycle of the run is asked once, from its begin to its end
    assert abs(out.printed("asked")[0] - (run.end_ns - run.begin_ns) / 1e6) < 20


@pytest.mark.long
def test_both_sides_of_a_gantry_stay_together(run_nc: Run) -> None:
    out = run_nc(
        "N10 G0 X100 X2=0\nN20 #SET AX LINK[1, [X2=X,G,15,20]]\nN30 #ENABLE AX LINK[1]\n"
        "N40 G1 X150 F6000\nN50 G1 X120\nN60 #DISABLE AX LINK[1]\nN70 G1 X2=0",
        "",
        base="gantry-x.toml",
    )
    assert out.alarms == []
    x, x2 = out.column("X.set_mm"), out.column("X2.set_mm")
    begin = int(np.argmax(x > 100.0 + 1e-9))
    end = int(np.flatnonzero(x > 120.0 + 1e-9)[-1])
    # both are what left the CNC; X2 was coupled where it stood
    assert np.abs(x2[begin:end] - (x[begin:end] - 100.0)).max() < 2 * INCREMENT_MM
    apart = out.column("X2.truth_mm")[begin:end] - out.column("X.truth_mm")[begin:end]
    assert np.abs(apart + 100.0).max() < 0.02
    assert (end_mm(out, "X"), end_mm(out, "X2")) == (
        pytest.approx(120.0, abs=0.01),
        pytest.approx(0.0, abs=0.01),
    )


@pytest.mark.long
def test_a_side_that_is_blocked_ends_the_program_at_the_first_limit(run_nc: Run) -> None:
    """X2 is blocked at 50 mm, 20 mm behind its start; it is 15 mm short when X has made 35 mm."""
    out = run_nc(
        "N20 #SET AX LINK[1, [X2=X,G,15,20]]\nN30 #ENABLE AX LINK[1]\nN40 G1 X60 F600",
        "[plant.x2]\nstart = { stop_position_mm = 50 }",
        base="gantry-x.toml",
    )
    assert out.alarms == [900192]
    (alarm,) = out.machine.channel.alarms
    difference_mm = float(alarm.values["difference_mm"])
    assert -15.0 - 10.0 * T_S - 0.001 < difference_mm < -15.0
    # at 10 mm/s: lag of X at the alarm, braking, and what the stop gives way
    assert end_mm(out, "X") == pytest.approx(35.0 + 10.0 / KV, abs=0.3)
    assert "N40" in str(alarm)


@pytest.mark.long
def test_the_program_goes_on_in_the_coordinates_of_the_reference(run_own: Run) -> None:
    """The lower edge of the home switch at 12 mm becomes 100 mm, so 110 mm lie at 22 mm."""
    out = run_own(PLANS / "programs" / "homing.nc", PLANS / "rigs" / "homing-z-g74.toml")
    assert out.alarms == []
    first, last = (float(line.split()[1]) for line in out.lines)
    # it stops behind the edge from 1 mm/s with 500 mm/s2, in a loop that lags by v/Kv
    assert 100.0 < first < 100.0 + 1.0 / 500.0 + 1.0 / KV
    assert last == 110.0
    # one tick of 250 us and the input delay at 1 mm/s; the window of the axis list is 0.1 um
    late_mm = 1.0 * (250e-6 + 4e-6)
    assert 22.0 - 1e-4 < end_mm(out, "Z") < 22.0 + late_mm + 1e-4


@pytest.mark.long
def test_a_run_behind_homing_measures_in_the_new_coordinates(run_nc: Run) -> None:
    """The face at 30 mm lies 18 mm above the edge that is 100 mm; 10 mm/s and 4 us of delay."""
    out = run_nc(
        'N10 G74 Z1\nN20 G100 Z130 F600\n#MSG SYN["Z=%f", V.A.MESS.Z]',
        """
[axis.Z]
probe_1 = "touch"
probe_2 = "touch"
[plant.touch]
fmu = "AxisRig.Sensors.TouchProbe"
start = { normal_x = 0, normal_y = 0, normal_z = -1, surface_mm = -30 }
wire = { z = "z" }
""",
        base="homing-z-g74.toml",
    )
    assert out.alarms == []
    (measured,) = out.printed("Z")
    late_mm, delay_mm = 1.0 * (250e-6 + 4e-6), 10.0 * 4e-6
    assert 118.0 + delay_mm - late_mm - INCREMENT_MM < measured < 118.0 + delay_mm + INCREMENT_MM
    # what the report compares with the truth of the plant
    zero_mm = out.observed.zero_mm("Z", out.facts.runs[0])
    assert zero_mm == pytest.approx(30.0 + delay_mm - measured, abs=INCREMENT_MM)


@pytest.mark.long
def test_homing_that_is_stopped_brings_the_axis_to_rest(run_nc: Run) -> None:
    """The operator stops the search at 20 mm/s; the drive brakes with 500 mm/s2 (609A)."""

    def stop(channel: Any) -> None:
        if channel.links[0].actual_mm > 5.0 and not channel.alarms:
            channel.stop(Alarm(900070))

    out = run_nc("N10 G74 Z1\nN20 G1 Z0 F600", "", base="homing-z-g74.toml", watch=stop)
    assert out.alarms == [900070]
    assert end_mm(out, "Z") == pytest.approx(5.0 + 20.0**2 / (2 * 500.0) + 20.0 / KV, abs=0.15)
    speed = np.diff(out.column("Z.truth_mm")[-20:])
    assert np.abs(speed).max() < 1e-3
