"""Limits of testplans/kinematics.csv from closed forms; nothing of the bench is imported.

A head with a lever of 180 mm from the A axis to the tool centre point, axes without lag: a set
position is met to half an increment, and between two SYNCs an axis goes straight.
"""

import csv
import math
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

PLANS = Path(__file__).parents[2] / "testplans"
RIG = PLANS / "rigs" / "probe-5axis.toml"
PERIOD_S, HD1_MM, TOOL_MM = 1e-3, 100.0, 80.0
LEVER_MM = HD1_MM + TOOL_MM
PER_DEG = math.radians(1.0)
PLACE_DEG = 0.5  # so far apart the path is looked at, docs/motion.md
MARGIN = 1.001  # on what is found there
A_MM_S2 = 800.0  # of the list, feed

with (PLANS / "kinematics.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file)}


def number(case: str, column: str) -> float:
    return float(ROWS[case][column])


def band(case: str, metric: str) -> tuple[float, float]:
    middle, width = ROWS[case][f"check:{metric}"].split(" +- ")
    return float(middle), float(width)


def most(case: str, metric: str) -> float:
    return float(ROWS[case][f"check:{metric}"].removeprefix("<= "))


def half_mm() -> float:
    drive = tomllib.loads(RIG.read_text(encoding="utf-8"))["drive"]["servo"]
    return float(drive["lead_mm"]) / int(drive["encoder_increments"]) / 2.0


def half_deg(case: str) -> float:
    """Half an increment of C and A, which a row may make finer."""
    drives = tomllib.loads(RIG.read_text(encoding="utf-8"))["drive"]
    counts = {
        int(ROWS[case][f"drive:{name}.encoder_increments"] or drives[name]["encoder_increments"])
        for name in ("worm", "tilt")
    }
    (count,) = counts
    return float(drives["worm"]["lead_mm"]) / count / 2.0


def away_um(case: str, tilt_deg: float, *, turns_c: bool) -> float:
    """Half an increment of each linear axis, lever times half an increment of A and of C."""
    turn_mm = LEVER_MM * half_deg(case) * PER_DEG
    of_c = math.sin(math.radians(tilt_deg)) if turns_c else 0.0
    return 1e3 * (math.sqrt(3.0) * half_mm() + turn_mm * math.hypot(1.0, of_c))


def test_the_figures_used_here_are_those_of_rig_and_lists() -> None:
    rig = tomllib.loads(RIG.read_text(encoding="utf-8"))
    start = rig["plant"]["probe"]["start"]
    assert (start["head.reach_mm"], start["tool_length_mm"]) == (HD1_MM, TOOL_MM)
    assert rig["cycle"]["period_us"] == PERIOD_S * 1e6
    lists = RIG.parent / "lists"
    channel = (lists / "channel-probe-5axis.lst").read_text(encoding="utf-8")
    assert re.search(rf"param\[0\]\s+{HD1_MM * 1e4:.0f} ", channel)
    tools = (lists / "tools-probe-5axis.lst").read_text(encoding="utf-8")
    assert re.search(rf"laenge\s+{TOOL_MM * 1e4:.0f} ", tools)
    axes = (lists / "axes-probe-5axis.lst").read_text(encoding="utf-8")
    assert axes.count("kenngr.messachse                            1 ") == 5
    assert len(re.findall(rf"\.a_stufe_[12]\s+{A_MM_S2:.0f} ", axes)) == 10


@pytest.mark.parametrize(
    ("case", "turns_c"),
    [
        ("turn-a", False),
        ("turn-c-a", True),
        ("line", True),
        ("line-held", True),
        ("line-override", True),
        ("system", True),
        ("touch-moving", True),
    ],
)
def test_the_tool_is_on_its_line_to_half_an_increment_and_the_lever(
    case: str, turns_c: bool
) -> None:
    tilt_deg = max(abs(number(case, "plc:V.E.A")), abs(float(ROWS[case]["plc:V.E.A_END"] or 0)))
    limit_um = most(case, "tcp_from_line_um_max")
    assert limit_um == pytest.approx(away_um(case, tilt_deg, turns_c=turns_c), abs=1e-4)
    if case == "turn-a":
        # 180 mm and 1e-4 degrees: 0.157 um
        turn_um = LEVER_MM * half_deg(case) * PER_DEG * 1e3
        assert turn_um == pytest.approx(0.157, abs=1e-4)


@pytest.mark.parametrize("case", ["turn-a", "turn-c-a", "line", "line-held", "system"])
def test_the_end_is_the_programmed_one(case: str) -> None:
    turned = Rotation.from_euler("X", 30, degrees=True)
    place = {
        "turn": (10.0, 20.0, 5.0),
        "line": (60.0, 30.0, 30.0),
        "system": np.add((10.0, 20.0, 5.0), turned.apply((40.0, 10.0, 15.0))),
    }[case.partition("-")[0]]
    error_mm = half_mm() + 2.0 * LEVER_MM * half_deg(case) * PER_DEG
    for axis, expected in zip("XYZ", place, strict=True):
        middle, width = band(case, f"tcp_mm:{axis}")
        assert middle == pytest.approx(expected, abs=1e-6)
        assert width == pytest.approx(error_mm, abs=1e-6)


@pytest.mark.parametrize(
    ("case", "share"), [("line", 1.0), ("line-held", 1.0), ("line-override", 0.5)]
)
def test_the_feed_is_that_of_the_tool_centre_point(case: str, share: float) -> None:
    """Two places, each off by as much as the line allows, over a cycle."""
    middle, width = band(case, "tcp_velocity_mm_s_max")
    assert middle == pytest.approx(share * number(case, "plc:V.E.FEED") / 60.0)
    error_um = 2.0 * away_um(case, abs(number(case, "plc:V.E.A")), turns_c=True)
    assert width == pytest.approx(error_um * 1e-3 / PERIOD_S, abs=1e-4)


def bend_mm() -> float:
    """Largest y'' of y = L sin a in mm/rad2 as second differences find it next to the end, and a
    thousandth more."""
    h = math.radians(PLACE_DEG)
    return MARGIN * LEVER_MM * math.cos(h) * (2.0 - 2.0 * math.cos(h)) / h**2


def test_a_turn_is_no_faster_than_half_of_the_acceleration_allows_on_the_curve() -> None:
    """w = sqrt(a / 2 / y''); the chord between two SYNCs is L (w T)^2 / 8."""
    w_rad_s = math.sqrt(A_MM_S2 / 2.0 / bend_mm())
    middle, width = band("feed-lowered", "velocity_deg_s_max:A")
    assert middle == pytest.approx(math.degrees(w_rad_s), abs=1e-3)
    assert width == pytest.approx(2.0 * half_deg("feed-lowered") / PERIOD_S * 2.0, rel=1e-6)
    assert number("feed-lowered", "plc:V.E.FEED") / 60.0 > 2.0 * middle
    chord_um, width_um = band("feed-lowered", "tcp_between_um_max")
    assert chord_um == pytest.approx(LEVER_MM * (w_rad_s * PERIOD_S) ** 2 / 8.0 * 1e3, abs=1e-4)
    turn_um = LEVER_MM * half_deg("feed-lowered") * PER_DEG * 1e3
    assert width_um == pytest.approx(math.sqrt(2.0) * half_mm() * 1e3 + turn_um, abs=1e-4)
    for axis in "YZ":
        for metric in ("set_acceleration_mm_s2_max", "set_deceleration_mm_s2_max"):
            assert most("feed-lowered", f"{metric}:{axis}") == A_MM_S2


def test_the_speed_of_an_axis_limits_the_turn() -> None:
    """y' = L cos a is largest at A = 0, where the turn begins from rest.

    Full speed comes after w^2/2u of the turn with (a - y'' w^2)/y' = u; there Y has cos of it.
    """
    limit_mm_s = number("speed-lowered", "set:Y.getriebe[0].dynamik.vb_max") / 1e3
    half_place = bend_mm() / MARGIN * math.radians(PLACE_DEG) / 2.0
    steep_mm = MARGIN * LEVER_MM + half_place
    w = limit_mm_s / steep_mm
    u = (A_MM_S2 - bend_mm() * w * w) / steep_mm
    fastest_mm_s = LEVER_MM * w * math.cos(w * w / 2.0 / u)
    middle, width = band("speed-lowered", "velocity_mm_s_max:Y")
    assert middle == pytest.approx(fastest_mm_s, abs=2e-3)
    assert width == pytest.approx(2.0 * half_mm() / PERIOD_S)
    assert middle + width < limit_mm_s


def test_a_latch_of_a_that_is_late_is_lever_times_angle_off() -> None:
    """A turns 25 degrees on the 32.016 mm from (10, 20) to (30, -5)."""
    case = "touch-skew"
    late_s = number(case, "drive:tilt.input_delay_us") * 1e-6
    turn_deg = abs(number(case, "plc:V.E.A_END") - number(case, "plc:V.E.A"))
    way_mm = math.dist((10.0, 20.0), (number(case, "plc:V.E.X"), -5.0))
    late_deg = turn_deg / way_mm * number(case, "plc:V.E.FEED") / 60.0 * late_s
    middle, width = band(case, "tcp_latch_error_um")
    assert middle == pytest.approx(LEVER_MM * late_deg * PER_DEG * 1e3, abs=1e-4)
    assert width == pytest.approx(away_um(case, 35.0, turns_c=False), abs=1e-4)
    middle, width = band(case, "latch_error_mdeg:A")
    assert middle == pytest.approx(late_deg * 1e3, abs=1e-4)
    assert width == pytest.approx(half_deg(case) * 1e3)


@pytest.mark.parametrize(
    ("case", "height_mm"), [("touch", 0), ("touch-ball", 2), ("touch-inclined", 0)]
)
def test_a_touch_of_a_head_that_does_not_turn_is_exact_to_half_an_increment(
    case: str, height_mm: float
) -> None:
    """0.6 x + 0.8 z = 6 mm is met at X10 with Z0; MOFFS is the value less the programmed Z-5."""
    middle, width = band(case, "msg:N50")
    assert middle == height_mm
    assert width == pytest.approx(half_mm(), abs=1e-9)
    assert band(case, "msg:N70")[0] == height_mm + 5.0
    assert most(case, "tcp_latch_error_um") == pytest.approx(
        math.sqrt(3.0) * half_mm() * 1e3, abs=1e-4
    )
    if case == "touch-inclined":
        normal = [number(case, f"plant:probe.probe.normal_{n}") for n in "xz"]
        assert normal[0] * 10.0 == number(case, "plant:probe.probe.surface_mm")
        assert math.hypot(*normal) == pytest.approx(1.0)


def test_what_is_refused_has_its_alarm() -> None:
    alarms = {name: row["check:alarms"] for name, row in ROWS.items() if "bad" in row["tags"]}
    assert alarms == {
        "line-limit": "== 120002",
        "touch-not-released": "== 50059",
        "touch-no-signal-a": "== 900003",
        "fixed-stop-source": "== 900241",
        "simulated-silent": "== 900003",
        "too-few-axes": "== 292040",
    }
    # With A -40 the Y axis is 180 sin 40 = 115.7 mm from the tool, which ends at Y30: above 100 mm
    assert 30.0 + LEVER_MM * math.sin(math.radians(40)) > 100.0
