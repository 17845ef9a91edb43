"""Which causes a value has by the source of its signal: braking, run-up, a position handed over."""

from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.record.signal_sources import AT_PLC, HELD, STAMPED
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.budget.budget import _causes_of
from axisrig.bench.tools.budget.causes import Active
from axisrig.bench.tools.budget.observed_run import Seen, Track
from axisrig.kernel.time.clock import MS

PLANS = Path(__file__).parents[2] / "testplans"
FEEDHOLDS = [f"set:Z.getriebe[0].{kind}.a_feedh" for kind in ("lslope_profil", "slope_profil")]
AT_ONCE = "10000000"
BY_DRIVE = ""


def row(*texts: str) -> Case:
    plan = read_plan(PLANS / "latch_accuracy.csv")
    return only(plan.with_inputs([parse_assignment(text) for text in texts]).cases, "f600")


def causes_of(rig: str, *assignments: str, **given: Any) -> dict[str, Active]:
    """Of a touch at -40 mm/s at an instant that a PLC has given, where nothing else is given."""
    settings = settings_of(PLANS / "rigs" / f"{rig}.toml", list(assignments))
    track = Track([0, MS], [1.0, 0.96], [-40.0, -40.0], 0, 1, 0.0)
    numbers = {"error_um": -40.0, "velocity_mm_s": -40.0, "latch_ms": None, "source_um": None,
            "track": track}  # fmt: skip
    found = _causes_of(row(), settings, "Z", Seen(**(numbers | given)))
    return {each.cause.cause: each for each in found}


def stop_of(found: dict[str, Active]) -> str | None:
    (stop,) = {found["braking"].off[column] for column in FEEDHOLDS}
    return stop


@pytest.mark.parametrize("speed_mm_s", [-40.0, 40.0])
@pytest.mark.parametrize(
    ("source", "after"),
    [(STAMPED, "80"), (HELD, "1"), *((each, "1") for each in AT_PLC if each not in (HELD, STAMPED)),
     (BY_DRIVE, "1")],
)  # fmt: skip
def test_a_stamp_only_touches_the_stop_that_comes_after_it(
    source: str, after: str, speed_mm_s: float
) -> None:
    """0.5 s from 40 mm/s: the history of a stamp has two cycles of it, others its whole begin."""
    given = {"source": source, "velocity_mm_s": speed_mm_s}
    assert stop_of(causes_of("probe-z", is_after_signal=True, **given)) == after
    assert stop_of(causes_of("probe-z", is_after_signal=False, **given)) == AT_ONCE


@pytest.mark.parametrize("source", [STAMPED, HELD, BY_DRIVE])
def test_the_run_up_is_a_cause_before_the_braking_where_the_axis_gains_speed(source: str) -> None:
    found = causes_of("probe-z", source=source, gains_speed=True)
    assert list(found)[-2:] == ["run-up", "braking"]
    assert "run-up" not in causes_of("probe-z", source=source, gains_speed=False)


def test_of_a_run_without_its_motion_neither_braking_nor_run_up_is_a_cause() -> None:
    """Nothing of the truth says at which speed it was."""
    found = causes_of("probe-z", "plant:probe.pretravel_um=8", track=None, gains_speed=True)
    assert "pre-travel" in found
    assert not {"braking", "run-up"} & set(found)


@pytest.mark.parametrize(
    ("source", "is_handed"), [(HELD, True), (STAMPED, False), (BY_DRIVE, False)]
)
def test_a_position_is_handed_over_where_external_hardware_latches(
    source: str, is_handed: bool
) -> None:
    found = causes_of("plc-external", "plc:V.E.POSITION=1", source=source)
    assert ("handed-over position" in found) is is_handed


@pytest.mark.parametrize(("latch_ms", "by_drive"), [(0.0, True), (0.5, True), (None, False)])
def test_what_a_latch_of_the_drive_adds_is_of_values_that_it_has_latched(
    latch_ms: float | None, by_drive: bool
) -> None:
    """One that is latched at the very contact has been latched as well."""
    found = causes_of("probe-z", "drive:servo.delay_compensation_us=20", latch_ms=latch_ms)
    assert ("compensation" in found) is by_drive


@pytest.mark.parametrize(
    ("farthest_mm", "finest"), [(0.0, 2**26), (150.0, 2**26), (300.0, 2**25), (331.0, 2**24)]
)
def test_finer_increments_reach_as_far_as_the_run_has_been(farthest_mm: float, finest: int) -> None:
    """2^31 increments, 10 mm in a turn, half of them kept free: 2^26 reach 160 mm, 2^25 320."""
    found = causes_of("probe-z", latch_ms=0.5, farthest_mm=farthest_mm)
    assert found["encoder"].off == {"drive:servo.encoder_increments": str(finest)}
