"""Shares against numbers worked out by hand: contact, braking, noise, what a PLC hands over."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from math import prod, sqrt
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts
from tests.tools.near import near

from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_case, run_cases
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.facts import Fault
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.record.series import Series
from axisrig.bench.tools.budget.budget import Budget, Share, make_budget
from axisrig.bench.tools.budget.causes import active_causes
from axisrig.bench.tools.budget.encoder import lost_um, normal_number
from axisrig.bench.tools.budget.surface import contact_um, normal_of, seat_um, way_per_length
from axisrig.kernel.time.clock import MS

PLANS = Path(__file__).parents[2] / "testplans"
RIGS = PLANS / "rigs"
NEAR_TARGET = """%near_target
N10 G01 G90 Z110 F3000
N20 G100 Z=V.E.TARGET F600
N30 M30
"""
IN_RUN_UP = """%in_run_up
N10 G01 G90 Z100.2 F3000
N20 G100 Z90 F3000
N30 M30
"""
OBLIQUE = """%oblique
N10 G01 G90 X10 Z103 F3000
N20 G100 X4 Z97 F600
N30 M30
"""


def row(plan: str, name: str, *texts: str) -> Case:
    given = [parse_assignment(text) for text in texts]
    return only(read_plan(PLANS / f"{plan}.csv").with_inputs(given).cases, name)


def budget_of(case: Case, axis: str | None = None) -> Budget:
    found = make_budget(case, axis, partial(run_cases, files_of=lambda _: RunFiles()))
    total = sum(share.in_turn_um for share in found.shares) + found.left_um
    assert total == pytest.approx(found.error_um, abs=1e-9)
    assert abs(found.left_um) <= found.increment_um
    assert found.differing == ()
    return found


def shares(budget: Budget) -> Mapping[str, Share]:
    return {share.cause.cause: share for share in budget.shares}


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def stiff_rig(folder: Path) -> Path:
    """A rig whose load is where the demand is."""
    text = (RIGS / "probe-z.toml").read_text(encoding="utf-8")
    text = text.replace('"lists/', f'"{RIGS}/lists/').replace("ServoAxis", "KinematicAxis")
    lines = [
        "start = { position_start_mm = 130 }" if line.startswith("start = { pos") else line
        for line in text.splitlines()
    ]
    return written(folder, "stiff.toml", "\n".join(lines))


def test_a_seat_yields_half_towards_a_pad_and_all_between_two() -> None:
    """F R/(2 L) = 8 N 10/(2 50) = 0.8 N towards a pad, twice as much between; 0.2 N/um."""
    for angle_deg, yields_um in ((0, 4.0), (60, 8.0)):
        settings = settings_of(row("probe_reality", f"lobing-{angle_deg}"))
        normal = normal_of(settings, "probe")
        assert normal == (1.0, 0.0, 0.0)
        assert seat_um(settings, "probe", normal) == pytest.approx(yields_um, rel=1e-12)


def test_ball_and_workpiece_yield_as_hertz_says() -> None:
    """Steel ball of 6 mm on aluminium, E = 53 GPa, 0.8 N: approach^3 = 9 F^2/(16 r E^2)."""
    case = row("probe_reality", "lobing-0", "plant:probe.contact_modulus=53e9")
    settings = settings_of(case)
    found_um = contact_um(settings, "probe", (1.0, 0.0, 0.0))
    want_m3 = 9 * 0.8**2 / (16 * 3e-3 * 53e9**2)
    assert (found_um * 1e-6) ** 3 == pytest.approx(want_m3, rel=1e-9)
    assert 0.3 < found_um < 0.4  # the order of magnitude of tables for touch probes


def test_a_length_along_the_normal_of_an_oblique_touch() -> None:
    """At 60 degrees to the normal the path is twice the length, of which an axis has its part."""
    velocity = {"x": 10.0 * sqrt(3) / 2, "z": -5.0, "Z": -5.0, "X": 10.0 * sqrt(3) / 2}
    assert way_per_length((0.0, 0.0, 1.0), velocity, "Z") == pytest.approx(-1.0)
    assert way_per_length((0.0, 0.0, 1.0), velocity, "X") == pytest.approx(sqrt(3))
    assert way_per_length((0.0, 0.0, 1.0), {**velocity, "z": 5.0}, "Z") is None


def test_noise_has_the_numbers_of_its_distribution() -> None:
    numbers = [normal_number(place, 3) for place in range(1, 4001)]
    mean = sum(numbers) / len(numbers)
    assert abs(mean) < 4 / sqrt(len(numbers))
    assert sum(n * n for n in numbers) / len(numbers) == pytest.approx(1.0, abs=0.1)
    assert normal_number(0, 3) == 0.0


@pytest.mark.parametrize("farthest_mm", [0.0, 100.0, 160.0, 331.0, -5000.0, 50_000.0])
def test_the_finer_increments_of_a_budget_still_reach_where_the_axis_was(
    farthest_mm: float,
) -> None:
    """32 bits on 10 mm: 2^26 increments reach 320 mm; a drive as fine as that has no rounding."""
    case = row("latch_accuracy", "f600")
    found = active_causes(
        case, settings_of(case), "Z", is_latched=True, farthest_mm=abs(farthest_mm)
    )
    encoder = [each for each in found if each.cause.form == "rounding"]
    if abs(farthest_mm) > 10_000.0:
        assert encoder == []
        return
    increments = int(str(encoder[0].off["drive:servo.encoder_increments"]))
    assert 2**20 < increments <= 2**26
    assert increments * abs(farthest_mm) / 10.0 < 2**31
    assert increments * abs(farthest_mm) / 10.0 * 4 >= 2**31 or increments == 2**26


@pytest.mark.long
def test_a_budget_far_from_zero_is_there(tmp_path: Path) -> None:
    """A touch at 330 mm, beyond the range of 2^26 increments."""
    program = written(tmp_path, "far.nc", "N10 G90 G100 Z329 F[V.E.FEED]\nN20 M30\n")
    texts = ["plant:z.position_start_mm=331", "plant:probe.surface_mm=330"]
    case = replace(row("latch_accuracy", "f600", *texts), program=program)
    assert "encoder" in shares(budget_of(case))


@pytest.mark.long
def test_contact_and_lobing_close_at_a_soft_workpiece() -> None:
    found = shares(budget_of(row("probe_reality", "lobing-20", "plant:probe.contact_modulus=2e9")))
    # 20 degrees from a pad: F = 0.8/cos 20 N
    force_n = 0.8 / 0.9396926
    want_um = (9 * force_n**2 / (16 * 3e-3 * 2e9**2)) ** (1 / 3) * 1e6
    assert found["contact"].in_turn_um == pytest.approx(-want_um, abs=0.01 * want_um)
    assert found["lobing"].in_turn_um == pytest.approx(-force_n / 0.2, rel=0.01)
    assert {name for name, share in found.items() if share.interacts} == {"lobing", "contact"}


@pytest.mark.long
def test_braking_has_no_share_where_the_value_is_of_before() -> None:
    for plan, name in (("latch_accuracy", "f600"), ("plc_sources", "ext-position")):
        braking = shares(budget_of(near(row(plan, name))))["braking"]
        assert braking.alone_um == braking.in_turn_um == 0.0


@pytest.mark.long
def test_a_delay_within_braking_costs_less_by_what_the_axis_slows_down(tmp_path: Path) -> None:
    """Load where the demand is, 1000 mm/s2, target 40 um below the surface, 3 ms late.

    v^2 = 2 a s: 8.944 mm/s at the contact; v t - a t^2/2 = 22.33 um in place of 30 um at the feed.
    The drive has a straight line between set positions: up to a T^2/8 = 0.125 um at either end.
    """
    case = Case(
        **{
            **vars(row("latch_accuracy", "f600")),
            "rig": stiff_rig(tmp_path),
            "program": written(tmp_path, "near.nc", NEAR_TARGET),
            "inputs": {"plc:V.E.TARGET": "99.96", "plant:probe.trigger_delay_us": "3000"},
        }
    )
    found = shares(budget_of(case))
    speed_mm_s = sqrt(2 * 1000 * 0.04)
    way_um = 3 * speed_mm_s - 1000 * 3**2 / 2 * 1e-3
    assert found["braking"].in_turn_um == pytest.approx(30 - way_um, abs=0.25)
    assert found["trigger"].in_turn_um == pytest.approx(-30.0, abs=0.01)
    assert found["braking"].interacts
    assert found["trigger"].interacts


@pytest.mark.long
def test_a_delay_within_the_run_up_costs_less_than_at_the_feed(tmp_path: Path) -> None:
    """Contact 0.2 mm after the begin with 1000 mm/s2, feed 50 mm/s, 5 ms late.

    v^2 = 2 a s: 20 mm/s at the contact; v t + a t^2/2 = 112.5 um in place of 250 um at the feed.
    """
    case = Case(
        **{
            **vars(row("latch_accuracy", "f600")),
            "rig": stiff_rig(tmp_path),
            "program": written(tmp_path, "run-up.nc", IN_RUN_UP),
            "inputs": {"plant:probe.trigger_delay_us": "5000"},
        }
    )
    found = shares(budget_of(case))
    assert found["trigger"].in_turn_um == pytest.approx(-250.0, abs=0.01)
    assert found["run-up"].in_turn_um == pytest.approx(
        250 - (20 * 5 + 1000 * 25 / 2 * 1e-3), abs=0.5
    )
    assert found["run-up"].interacts


@pytest.mark.long
def test_an_axis_whose_signal_comes_later_is_measured_while_it_brakes(tmp_path: Path) -> None:
    """The input of Z is 20 ms late; the signal of X has stopped the path by then."""
    rig = f"""base = "{RIGS}/probe-xyz.toml"
title = "Z with a slow input"
[drive.slow]
encoder_increments = 1_048_576
lead_mm = 10.0
input_delay_us = 20000.0
[axis.Z]
drive = "slow"
"""
    inputs = {
        f"plant:{axis}.{name}_friction_n": "0" for axis in "xz" for name in ("coulomb", "breakaway")
    }
    case = Case(
        **{
            **vars(row("latch_accuracy", "f600")),
            "rig": written(tmp_path, "late.toml", rig),
            "program": written(tmp_path, "oblique.nc", OBLIQUE),
            "inputs": inputs,
        }
    )
    found = shares(budget_of(case, "Z"))
    # Without braking v t at 10 mm/s along the path, of which Z has cos 45 degrees
    assert found["input"].in_turn_um == pytest.approx(-200 / sqrt(2), rel=0.01)
    # It brakes within 10 ms and lags: more than nothing, less than what is left after 2 ms
    assert 10.0 < found["braking"].in_turn_um < 0.9 * 200 / sqrt(2)


@pytest.mark.long
def test_a_level_sampled_at_the_sync_waits_for_it() -> None:
    """60FD: from the edge to the SYNC, v U; then to the cycle of the PLC and back to the SYNC."""
    budget = budget_of(near(row("plc_sources", "plc-drive-input")))
    found = shares(budget)
    assert -10.0 <= found["digital input"].in_turn_um < 0.0
    # From SYNC to SYNC: whole cycles of 10 um, the PLC with its shortest cycle
    assert found["CNC cycle"].in_turn_um == pytest.approx(-10.0, abs=budget.increment_um)


@pytest.mark.long
def test_a_position_of_the_plc_is_older_by_the_cycles_between() -> None:
    """HLI of the NC cycle before the PLC's in place of the SYNC after it: 1 ms at 10 mm/s."""
    found = shares(budget_of(near(row("plc_sources", "ext-position"))))
    assert found["handed-over position"].in_turn_um == pytest.approx(10.0, abs=0.1)


@pytest.mark.long
def test_the_last_edge_of_an_exchange_keeps_its_stamp() -> None:
    """Bounces of 2 ms within an exchange of 10 ms: v t = 20 um, which needs all three."""
    found = shares(budget_of(row("plc_sources", "stamp-last-edge")))
    acting = {name: share for name, share in found.items() if share.interacts}
    assert set(acting) == {"bounce", "stamp edge", "terminal cycle"}
    for share in acting.values():
        assert share.combined_um == pytest.approx(-20 / 3, abs=0.01)


@pytest.mark.parametrize("hits", [1, 2])
@pytest.mark.parametrize("source", ["PLC", "DRIVE"])
def test_what_a_cubic_lacks_at_a_lost_position_is_the_remainder_of_lagrange(
    source: str, hits: int
) -> None:
    """x = c t^4: the cubic through four points is c (t - t1) .. (t - t4) off, exactly.

    Rows 19 and 20, or row 20, were lost; two on either side of them are left.
    """
    c, times_ms = 1e-6, np.arange(40, dtype=np.int64)
    words = f"drop=Z.TPDO1: {hits} {'frame hit' if hits == 1 else 'frames hit, the last'}"
    found = facts(
        axes={"Z": AxisRecord("can1", 1, 1000.0)},
        faults=(Fault("Z", "", ((20 * MS, words), (30 * MS, "drop=Z.TPDO1: ends"))),),
        runs=(MeasurementRun(("Z",), sources={"Z": source}),),
    )
    table = pa.table({"time_ns": times_ms * MS, "Z.truth_mm": c * times_ms.astype(float) ** 4})
    observed = Observed(found, Series(table))
    first = 21 - hits
    points = (first - 2, first - 1, 21, 22)
    for row in range(first, 21):
        off_mm = -c * prod(row - point for point in points)
        of_row = lost_um(observed, "Z", row * MS, is_latched=False)
        assert of_row == pytest.approx(off_mm * 1e3, abs=1e-9)
        assert abs(of_row) > 1e-3
        # A drive that has stored the value has lost nothing
        assert lost_um(observed, "Z", row * MS, is_latched=True) == 0.0
    for row in (first - 1, 21, 30):
        assert lost_um(observed, "Z", row * MS, is_latched=False) == 0.0
    # Nor has a value of a time stamp, which is taken from the history of positions
    stamped = replace(found, runs=(MeasurementRun(("Z",), sources={"Z": "PLC_TIMESTAMP"}),))
    assert lost_um(Observed(stamped, Series(table)), "Z", 20 * MS, is_latched=False) == 0.0


@pytest.mark.long
def test_a_lost_position_follows_from_those_around_it(tmp_path: Path) -> None:
    """While the axis brakes a cubic is right where a line over 2 T is off by a T^2/2 = 0.5 um."""
    case = Case(
        **{
            **vars(row("plc_sources", "plc-f600")),
            "program": written(tmp_path, "near.nc", NEAR_TARGET),
            "checks": (),  # of messages that this program does not have
            "inputs": {"plc:V.E.TARGET": "99.90", "plant:z.feed_forward": "1", "plant:z.kv": "200"},
        }
    )
    whole = run_case(case, RunFiles())
    assert whole.facts is not None
    signal_ns = whole.facts.runs[-1].signal_ns
    assert signal_ns is not None
    assert whole.facts.start_ns is not None
    at_ms = (signal_ns - whole.facts.start_ns) / MS - 0.7
    lost = Case(
        **{
            **vars(case),
            "inputs": {**case.inputs, "fault:drop": f"Z.TPDO1 at={at_ms:.1f}ms count=1"},
        }
    )
    share = shares(budget_of(lost))["PDO"]
    assert share.expected_um is not None
    assert share.alone_um != 0.0  # the fault has hit the telegram of the value
    assert abs(share.alone_um) < 0.05
