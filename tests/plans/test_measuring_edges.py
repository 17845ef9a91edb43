"""Every limit of testplans/measuring_edges.csv, recomputed from closed forms written out here.

Nothing of the bench is imported: rigs, programs and plan are read as the text files they are.
Lengths in mm, times in s.
"""

import csv
import math
import tomllib
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"

with (PLANS / "measuring_edges.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file)}

RIG = tomllib.loads((PLANS / "rigs" / "probe-z.toml").read_text(encoding="utf-8"))
DELAY_S = RIG["drive"]["servo"]["input_delay_us"] * 1e-6
KV = RIG["plant"]["z"]["start"]["kv"]
SURFACE_MM = RIG["plant"]["probe"]["start"]["surface_mm"]
TYPE_2_MM_S = 16.666  # P-AXIS-00215, its default
INCREMENT_MM = RIG["drive"]["servo"]["lead_mm"] / RIG["drive"]["servo"]["encoder_increments"]
RISING, FALLING = ("msg:N30", "msg:N110"), ("msg:N70", "msg:N150")


def limit(case: str, check: str) -> tuple[float, float]:
    """Middle and width of a check `== a` or `a +- b`."""
    text = ROWS[case][f"check:{check}"]
    middle, _, width = text.removeprefix("== ").partition(" +- ")
    return float(middle), float(width or 0.0)


def latched_mm(case: str, speed_mm_s: float, surface_mm: float = SURFACE_MM) -> float:
    """A drive latches its input delay late: v t_d behind the edge, in the direction of motion."""
    assert ROWS[case]["rig"].startswith("rigs/probe-z")
    return surface_mm + speed_mm_s * DELAY_S


def is_near(case: str, check: str, expected_mm: float) -> bool:
    """Whether a limit is the value to its digits, and no wider than an increment, rounded up."""
    middle, width = limit(case, check)
    return abs(middle - expected_mm) < 0.51e-5 and INCREMENT_MM < width <= 1.1 * INCREMENT_MM


@pytest.mark.parametrize("case", ["edges-600", "edges-1500"])
def test_a_rising_edge_lies_below_and_a_falling_one_above_the_surface(case: str) -> None:
    v = float(ROWS[case]["plc:V.E.FEED"]) / 60
    assert all(is_near(case, check, latched_mm(case, -v)) for check in RISING)
    assert all(is_near(case, check, latched_mm(case, v)) for check in FALLING)


def test_what_is_not_mapped_is_refused_after_what_is() -> None:
    assert is_near("edges-not-mapped", "msg:N30", latched_mm("edges-not-mapped", -10.0))
    assert is_near("input-not-mapped", "msg:N70", latched_mm("input-not-mapped", 10.0))
    for case in ("edges-not-mapped", "input-not-mapped"):
        assert ROWS[case]["check:alarms"] == "== 900223"


def test_the_first_of_two_runs() -> None:
    assert is_near("twice", "msg:N40", latched_mm("twice", -10.0))
    assert (ROWS["twice"]["check:msg:N70"], ROWS["twice"]["check:alarms"]) == ("== 0", "== 900101")


def rest_s(speed_mm_s: float, window_mm: float, period_s: float) -> float:
    """When a position loop comes to rest behind the end of its set path.

    The rest v/Kv decays with Kv; at rest it is inside the window and loses an increment a cycle.
    """
    rest_mm = min(window_mm, INCREMENT_MM / (KV * period_s))
    return math.log(speed_mm_s / KV / rest_mm) / KV


@pytest.mark.parametrize("case", [name for name in ROWS if name.startswith(("late", "creeping"))])
def test_edges_about_the_standstill(case: str) -> None:
    """The rest of the way at the contact is 0.02 mm; the edge comes its delay later."""
    row = ROWS[case]
    v = TYPE_2_MM_S if row["plc:V.E.TYPE"] == "2" else float(row["plc:V.E.FEED"]) / 60
    target, surface = float(row["plc:V.E.TARGET"]), float(row["plant:probe.surface_mm"])
    contact_s = math.log(v / KV / (surface - target)) / KV
    edge_s = contact_s + float(row["plant:probe.trigger_delay_us"]) * 1e-6
    left_s = edge_s - rest_s(v, 1e-4, 1e-3)
    counts = left_s < 0
    assert abs(left_s) > 0.01, "too near to be sure with a real drive"
    assert counts is case.startswith("creeping")
    if counts:
        low, high = map(float, row["check:msg:N50"].split(" .. "))
        assert target < low < target + (surface - target) * math.exp(-KV * 0.04) < high < surface
        low, high = map(float, row["check:msg:N60"].split(" .. "))
        assert 0 < low < high < surface - target
    alarms = "== 900004" if row["plc:V.E.TYPE"] == "2" and not counts else "none"
    assert row["check:alarms"] == alarms
    assert row["check:msg:N30"] == ("" if alarms != "none" else f"== {int(counts)}")


def test_late_edges_come_within_the_16_cycles_that_once_counted() -> None:
    """10 cycles in the window and 16 more: type 1 at 10 mm/s."""
    edge_s = math.log(10.0 / KV / 0.02) / KV + 0.150
    assert 0.001 < edge_s - rest_s(10.0, 1e-4, 1e-3) < 0.026


def test_an_edge_behind_the_target_counts_as_far_as_the_offset_goes() -> None:
    for case, counts in (("in-offset", True), ("behind-offset", False)):
        row = ROWS[case]
        end_mm = float(row["plc:V.E.TARGET"]) - float(row["set:Z.kenngr.probing_offset"]) / 1e4
        surface_mm = float(row["plant:probe.surface_mm"])
        assert (surface_mm > end_mm) is counts
    value_mm = latched_mm("in-offset", -TYPE_2_MM_S, 104.5)
    assert is_near("in-offset", "msg:N50", value_mm)
    assert is_near("in-offset", "msg:N60", value_mm - 105.0)


@pytest.mark.parametrize("case", ["path-offset", "path-offset-0"])
def test_the_axis_that_allows_least_ends_the_path(case: str) -> None:
    """From (0, 130) to (20, 110) both axes go the same way."""
    row = ROWS[case]
    more = min(float(row[f"set:{axis}.kenngr.probing_offset"] or 0) for axis in "XZ") / 1e4
    assert limit(case, "msg:N40") == (20 + more, 0)
    assert limit(case, "msg:N50") == (110 - more, 0)
    assert row["check:msg:N30"] == "== 0"


@pytest.mark.parametrize(("case", "period_us"), [("path-in-offset", 1000), ("path-2ms", 2000)])
def test_a_surface_behind_the_target_of_a_path(case: str, period_us: int) -> None:
    row = ROWS[case]
    assert limit(case, "msg:N70") == (float(row["plant:probe.surface_mm"]) - 110, 1e-5)
    assert row["check:msg:N30"] == "== 1"
    rig = tomllib.loads((PLANS / row["rig"]).read_text(encoding="utf-8"))
    assert rig["cycle"]["period_us"] == period_us


def test_the_rig_of_2_ms_has_three_axes_on_two_buses() -> None:
    rig = tomllib.loads((PLANS / "rigs/probe-xyz-2ms.toml").read_text(encoding="utf-8"))
    assert [axis["segment"] for axis in rig["axis"].values()] == ["can1", "can1", "can2"]


def test_a_measurement_offset_across_cs_off() -> None:
    """z of the point at Z 55.5 in a system at Z 75, turned by 15 degrees about Y, at its x 150:
    55.5 = 75 - x sin 15 + z cos 15. The target of the run was -10.
    """
    angle = math.radians(15)
    offset_mm = (55.5 - 75 + 150 * math.sin(angle)) / math.cos(angle) + 10
    for check, expected_mm in (
        ("msg:N40", offset_mm),
        ("msg:N60", offset_mm),
        ("msg:N90", 0.0),
        ("msg:N100", offset_mm),
        ("msg:N120", offset_mm),
        ("msg:N140", 150 + offset_mm),
    ):
        middle, width = limit("cs-off", check)
        assert abs(middle - expected_mm) < 0.51e-4, check
        assert width <= 1e-4


def test_a_ball_on_an_oblique_run_is_corrected_along_the_run() -> None:
    """It touches with its lowest point, at centre - r; the run goes (60, -80)/100."""
    radius_mm, along = 2.0, (0.6, -0.8)
    centre_mm = SURFACE_MM + radius_mm
    assert limit("oblique-ball", "msg:N40")[0] == centre_mm
    assert limit("oblique-ball", "msg:N50")[0] == pytest.approx(centre_mm + along[1] * radius_mm)
    assert limit("oblique-ball", "msg:N60")[0] == pytest.approx(along[0] * radius_mm)
    too_high_mm = radius_mm * (1 + along[1])
    shown_mm = limit("oblique-ball", "msg:N50")[0]
    assert shown_mm - SURFACE_MM == pytest.approx(too_high_mm) == pytest.approx(0.4)


def test_a_run_beside_the_program() -> None:
    """The stop of X is at 60, the target of the third run at 100; the fourth is asked too early."""
    row = ROWS["beside"]
    assert [row[f"check:msg:{n}"] for n in ("N50", "N80")] == ["== 0", "== 0"]
    assert limit("beside", "msg:N130")[0] == limit("beside", "msg:N120")[0] - 100 == -40
    assert row["check:alarms"] == "== 900101"
