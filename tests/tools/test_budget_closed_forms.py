"""Closed forms of shares and the words of a budget, from settings and motion that are written down.

The motion is x = 100 - 10 t + 1000 t^2 (mm, s) with the contact at 2 ms: the axis brakes.
"""

import math
from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.record.signal_sources import STAMPED
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.budget import closed_forms
from axisrig.bench.tools.budget.budget import CYCLES, Budget, Share
from axisrig.bench.tools.budget.causes import Active, causes
from axisrig.bench.tools.budget.closed_forms import bound_um, expected_um
from axisrig.bench.tools.budget.observed_run import Seen, Track
from axisrig.bench.tools.budget.surface import (
    contact_um,
    normal_of,
    seat_um,
    trigger_force_n,
    way_per_length,
)
from axisrig.bench.tools.budget.words import LEFT, budget_lines, budget_table, not_explained
from axisrig.kernel.time.clock import MS

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
TIMES = [k * MS for k in range(9)]


def place_mm(ms: float) -> float:
    return 100 - 10 * ms * 1e-3 + 1000 * (ms * 1e-3) ** 2


def moved_um(begin_ms: float, end_ms: float) -> float:
    """Between two instants after the contact."""
    return (place_mm(2 + end_ms) - place_mm(2 + begin_ms)) * 1e3


def track(touches: int = 1, edge_ms: float = 0.3) -> Track:
    speeds = [-10 + 2000 * k * 1e-3 for k in range(9)]
    return Track(TIMES, [place_mm(k) for k in range(9)], speeds, 2 * MS, touches, edge_ms)


def seen(**given: Any) -> Seen:
    values = {"error_um": -30.0, "velocity_mm_s": -6.0, "latch_ms": None, "source_um": None,
              "track": track()}  # fmt: skip
    return Seen(**(values | given))


def active(form: str, value: str = "1", setting: str = "") -> Active:
    cause = next(cause for cause in causes() if cause.form == form)
    return Active(cause, value, setting, {})


def settings(start: Mapping[str, object] | None = None) -> Any:
    plants = {"probe": SimpleNamespace(start=start or {}), "z": SimpleNamespace(start=start or {})}
    axis = SimpleNamespace(probe_1="probe", plant="z", drive="servo")
    return SimpleNamespace(rig=SimpleNamespace(axis={"Z": axis}, plant=plants), start={})


def form(name: str, later: Seen, without: Seen, value: str = "1", **start: object) -> Any:
    return expected_um(active(name, value), settings(start), "Z", later, without)


LATCHED = seen(latch_ms=1.5)


@pytest.mark.parametrize(
    ("name", "value", "later", "without", "share_um"),
    [
        # A time, us, after the latch that there is without it: as far as the axis moves in it
        ("time", "500", LATCHED, seen(latch_ms=1.0), moved_um(1.0, 1.5)),
        ("time", "500", LATCHED, seen(), moved_um(0.0, 0.5)),
        ("minus_time", "250", LATCHED, seen(latch_ms=1.0), -moved_um(0.75, 1.0)),
        # Led back by the speed at the latch: -10 + 2000 * 3e-3 = -4 mm/s
        ("led_back", "500", LATCHED, seen(latch_ms=1.0), 4.0 * 0.5),
        ("drawn", "300", LATCHED, seen(latch_ms=1.25), moved_um(1.25, 1.5)),
        ("rest", "400", LATCHED, seen(latch_ms=1.0), moved_um(1.0, 1.4)),
        ("length", "8", LATCHED, seen(), -8.0),
        ("length", "8", seen(latch_ms=1.5, per_length=-0.5), seen(), -4.0),
        ("half", "8", LATCHED, seen(), -4.0),
        ("half", "8", seen(latch_ms=1.5, velocity_mm_s=6.0, per_length=-0.5), seen(), 4.0),
        ("first", "3", LATCHED, seen(), -3.0),
        ("first", "3", seen(latch_ms=1.5, track=track(2)), seen(), 0.0),
        ("drift", "3", LATCHED, seen(), 0.0),
        ("drift", "3", seen(latch_ms=1.5, track=track(4)), seen(), -9.0),
        ("drift", "3", seen(latch_ms=1.5, track=None), seen(), None),
        ("edge", "1", seen(latch_ms=1.5, track=track(1, 0.9)), seen(), moved_um(0.3, 0.9)),
        ("edge", "1", seen(latch_ms=1.5, track=None), seen(), None),
        ("motion", "1", LATCHED, seen(latch_ms=1.25), moved_um(1.25, 1.5)),
        ("motion", "1", LATCHED, seen(track=None), None),
        ("noise", "0.5", seen(latch_ms=1.5, noise=-3.0), seen(latch_ms=1.5), -1.5),
        ("noise", "0.5", seen(value_ms=1.5, noise=2.0), seen(value_ms=1.0), 1.0 + moved_um(1, 1.5)),
        # A source gives the position of an instant: the ways to both differ
        ("source", "1", seen(value_ms=3.0), seen(value_ms=1.0), moved_um(1.0, 3.0)),
        ("handed", "1", seen(value_ms=3.0), seen(), None),
        ("pdo", "1", seen(value_ms=3.0), seen(value_ms=1.0), moved_um(1.0, 3.0)),
        ("pdo", "1", LATCHED, seen(latch_ms=1.0), 0.0),
        # Without a latch a time, a length or an edge acts by the cycle that finds it
        ("time", "500", seen(value_ms=3.0), seen(value_ms=1.0), moved_um(1.0, 3.0)),
        ("length", "8", seen(value_ms=3.0), seen(value_ms=1.0), moved_um(1.0, 3.0)),
        ("length", "8", seen(value_ms=3.0, source=STAMPED), seen(value_ms=1.0), -8.0),
        ("edge", "1", seen(value_ms=3.0, source=STAMPED, track=track(1, 0.9)),
         seen(), moved_um(0.3, 0.9)),
    ],
)  # fmt: skip
def test_the_closed_form_of_a_share(
    name: str, value: str, later: Seen, without: Seen, share_um: float | None
) -> None:
    found = form(name, later, without, value)
    assert found is None if share_um is None else found == pytest.approx(share_um, abs=1e-9)


def test_a_fault_that_changes_what_a_telegram_says_has_no_closed_form() -> None:
    both = "fault:drop Z.TPDO1, fault:second_sender Z.TPDO1"
    for setting, is_there in (
        ("fault:drop Z.TPDO1", True), ("fault:alter Z.TPDO1", False), (both, False),
    ):  # fmt: skip
        cause = active("pdo", setting=setting)
        found = expected_um(cause, settings(), "Z", seen(value_ms=3.0), seen(value_ms=1.0))
        assert (found is not None) is is_there


@pytest.mark.parametrize(("value", "is_line"), [("sampled", False), ("linear", True)])
def test_what_samples_lack(value: str, is_line: bool) -> None:
    """The latch at 2 + 1.02 ms is 0.02 ms after sample 48 of 62.5 us, 0.06 ms after 37 of 80 us."""
    without = seen(latch_ms=1.02)
    for family, sample_us, since_ms in (
        ("", 62.5, 0.02), ("", 80.0, 0.06), ("-profidrive", 80.0, 0.06), ("-sercos", 62.5, 0.02),
        ("-conventional", 80.0, 0.06), ("-ethercat", 80.0, 0.06),
    ):  # fmt: skip
        rig = settings_of(RIGS / f"probe-z{family}.toml", [f"drive:servo.sample_us={sample_us}"])
        found = expected_um(active("sampling", value), rig, "Z", seen(latch_ms=1.02), without)
        begin_ms, sample_ms = 1.02 - since_ms, sample_us * 1e-3
        share = since_ms / sample_ms if is_line else 0.0
        on_line = moved_um(begin_ms, begin_ms + sample_ms) * share
        assert found == pytest.approx(moved_um(1.02, begin_ms) + on_line, abs=1e-9), family
    unknown = seen(latch_ms=1.0, track=None)
    assert expected_um(active("sampling", value), rig, "Z", unknown, without) is None


@pytest.mark.parametrize(
    ("count", "bounce_us", "filter_us", "rest_ms"),
    [(0, 1000, 400, 0.4), (2, 1000, 200, 0.2), (2, 1000, 250, 0.25), (2, 1000, 251, 1.251),
     (1, 600, 301, 0.901)],
)  # fmt: skip
def test_a_filter_waits_for_the_end_of_a_bounce(
    count: int, bounce_us: float, filter_us: float, rest_ms: float
) -> None:
    """2 n changes within T: a level that stays T/(2 n) passes a filter that is no longer."""
    given = {"bounce_count": count, "bounce_time_us": bounce_us}
    found = form("rest", LATCHED, seen(latch_ms=0.5), str(filter_us), **given)
    assert found == pytest.approx(moved_um(0.5, 0.5 + rest_ms), abs=1e-9)


@pytest.mark.parametrize(("share", "power"), [(1.0, -1.0), (0.5, -0.25), (2.0, -4.0), (0.0, 0.0)])
def test_dry_friction_falls_with_the_square_of_the_speed(share: float, power: float) -> None:
    """F_c + (F_s - F_c) exp(-(v/v_s)^2): 60 N and 40 N more at rest, over 100 N/um."""
    cause = next(each for each in causes() if each.form == "twist")
    coulomb, breakaway = cause.key.split()
    given = {f"{coulomb}_n": 60, f"{breakaway}_n": 100, "screw_stiffness_n_m": 100e6,
             "friction.stribeck_m_s": 6e-3}  # fmt: skip
    force_n = 60 + 40 * math.exp(power)
    for sign in (1, -1):
        at = seen(velocity_mm_s=math.copysign(share * 6.0, sign))
        assert form("twist", at, seen(), **given) == pytest.approx(sign * force_n / 100)


def test_a_screw_is_twisted_by_friction() -> None:
    """F_c + (F_s - F_c) exp(-(v/v_s)^2) over the stiffness, 6 mm/s; viscous v times its number."""
    cause = next(each for each in causes() if each.form == "twist")
    coulomb, breakaway = cause.key.split()
    given = {f"{coulomb}_n": 60, f"{breakaway}_n": 100, "screw_stiffness_n_m": 100e6,
             "friction.stribeck_m_s": 6e-3}  # fmt: skip
    force_n = 60 + 40 * math.exp(-1)
    assert form("twist", LATCHED, seen(), **given) == pytest.approx(-force_n / 100)
    up = seen(velocity_mm_s=6.0)
    assert form("twist", up, seen(), **given) == pytest.approx(force_n / 100)
    viscous = form("viscous", up, seen(), "2000", screw_stiffness_n_m=100e6)
    assert viscous == pytest.approx(6e-3 * 2000 / 100)
    assert form("viscous", LATCHED, seen(), "2000") == pytest.approx(-6e-3 * 2000 / 120)


def test_how_large_a_share_may_be() -> None:
    for name, value, bound in (
        ("rounding", "1", 0.095),
        ("jitter", "5000", 0.03),
        ("time", "1", None),
    ):
        found = bound_um(active(name, value), settings(), "Z", LATCHED, 0.095)
        assert found == (None if bound is None else pytest.approx(bound))


# --- surface


@pytest.mark.parametrize(
    ("start", "normal"),
    [
        ({}, (0.0, 0.0, 1.0)),
        ({"normal_x": 0.6, "normal_z": 0.8}, (0.6, 0.0, 0.8)),
        ({"normal_y": 0.6}, (0.0, 0.6, 1.0)),
        ({"workpiece.sine.amplitude_um": 0}, (0.0, 0.0, 1.0)),
        ({"workpiece.sine.amplitude_um": 1}, None),
        *(
            ({f"workpiece.{key}": 10}, None)
            for key in (
                "inclined.angle_deg",
                "ramp.rise_mm",
                "step.rise_mm",
                "cylinder.radius_mm",
                "hole.radius_mm",
                *(f"waviness.amplitude[{n}]_um" for n in (1, 2, 3, 4)),
            )
        ),
        ({"workpiece.border.position_mm": 20}, (1.0, 0.0, 0.0)),
        ({"workpiece.border.position_m": 1000}, (0.0, 0.0, 1.0)),  # out of reach: the default
        ({"workpiece.border.position_mm": 20, "workpiece.border.azimuth_deg": 90}, (0.0, 1.0, 0.0)),
    ],
)
def test_the_normal_of_a_surface(start: dict[str, object], normal: Any) -> None:
    found = normal_of(settings(start), "probe")
    assert found == (None if normal is None else pytest.approx(normal, abs=1e-12))


def test_the_way_per_length() -> None:
    velocity = {"x": 3.0, "z": -4.0, "X": 3.0, "Z": -4.0}
    assert way_per_length((0, 0, 1), velocity, "Z") == -1.0
    assert way_per_length((-0.6, 0, 0.8), velocity, "Z") == pytest.approx(-4 / 5)
    assert way_per_length((0.8, 0, 0.6), velocity, "Z") is None  # along the surface
    assert way_per_length((0, 0, -1), velocity, "Z") is None  # away from it
    assert way_per_length((0, 1, 0), velocity, "Z") is None


@pytest.mark.parametrize("azimuth_deg", [0, 30, 60, 100, 180, 240, 330])
@pytest.mark.parametrize("up", [0.0, 0.5])
def test_the_force_at_which_a_pad_is_without_load(azimuth_deg: float, up: float) -> None:
    """Balance of moments: pads at 15, 135 and 255 degrees and R = 8 mm share F_p/3 each; a force
    at L = 40 mm adds 2 L/(3 R) cos(azimuth - pad) of itself, along the axis a third.
    """
    side = math.sqrt(1 - up * up)
    azimuth = math.radians(azimuth_deg)
    normal = side * math.cos(azimuth), side * math.sin(azimuth), up
    given = {"seat_force_n": 6, "stylus_length_mm": 40, "seat_radius_mm": 8, "seat_angle_deg": 15,
             "bending_stiffness_n_m": 1e5, "axial_stiffness_n_m": 1e6}  # fmt: skip
    force_n = trigger_force_n(settings(given), "probe", normal)
    loads = [
        2.0 - force_n * (up / 3 + 2 * 40 / (3 * 8) * side * math.cos(azimuth - math.radians(pad)))
        for pad in (15, 135, 255)
    ]
    assert min(loads) == pytest.approx(0.0, abs=1e-9)
    yields_um = force_n * (side**2 / 1e5 + up**2 / 1e6) * 1e6
    assert seat_um(settings(given), "probe", normal) == pytest.approx(yields_um)
    assert contact_um(settings(given), "probe", normal) == 0.0
    given |= {"contact_modulus": 50e9, "ball_radius_mm": 3}
    approach_m = (9 * force_n**2 / (16 * 3e-3 * 50e9**2)) ** (1 / 3)
    assert contact_um(settings(given), "probe", normal) == pytest.approx(approach_m * 1e6)


# --- words


def share(um: float, **more: Any) -> Share:
    values = {"cause": active("time").cause, "setting": "trigger_delay 120 us", "alone_um": um + 1,
              "in_turn_um": um, "expected_um": None, "bound_um": None}  # fmt: skip
    return Share(**(values | more))


def budget(*shares: Share, **given: Any) -> Budget:
    values = {"run": "plan.row", "axis": "Z", "error_um": -9.5, "velocity_mm_s": -10.0,
              "increment_um": 0.01, "left_um": 0.0, "shares": shares,
              "frame_log_sha256": "abc"}  # fmt: skip
    return Budget(**(values | given))


@pytest.mark.parametrize(
    ("speed", "words"), [(-10.0, "smaller"), (10.0, "larger"), (0.0, "larger")]
)
def test_the_head_of_a_budget(speed: float, words: str) -> None:
    lines = budget_lines(budget(share(-1.5), velocity_mm_s=speed))
    assert lines[0] == (
        "plan.row, axis Z: published value -9.5000 um from the contact, at"
        f" {abs(speed):g} mm/s towards {words} positions"
    )
    assert "mean um" not in lines[2]
    trigger = active("time").cause
    assert lines[-1] == f"largest: trigger, {trigger.meaning} (trigger_delay 120 us)"


def test_the_lines_of_a_budget() -> None:
    shares = (
        share(-8.0, expected_um=-8.0, combined_um=-7.5, interacts=True),
        share(-1.5, expected_um=-1.2, combined_um=-1.0),
        share(0.004, bound_um=0.01, combined_um=0.004),
    )
    lines = budget_lines(
        budget(*shares, left_um=0.01, kept_on=("run-up",), not_combined=("radio", "drift"))
    )
    assert lines[2].split()[-2:] == ["mean", "um"]
    cells = [line[65:].split() for line in lines[3:8]]
    assert cells == [
        ["-7.0000", "-8.0000", "-8.0000", "-7.5000"],
        ["-0.5000", "-1.5000", "-1.2000", "-1.0000", "differs", "by", "-0.3000"],
        ["+1.0040", "+0.0040", "+-", "0.0100", "+0.0040"],
        ["-9.4960"],
        ["+0.0100"],
    ]
    assert lines[6].startswith("all causes")
    assert lines[7].startswith(LEFT)
    said = "\n".join(lines[8:])
    for words in (
        "differs from its closed form, by more than 1 % and an increment: trigger",
        "these act on each other, more than an increment; mean = over all orders: trigger",
        "not switched off, as there is no value without: run-up",
        "not combined, only in turn; --combinations allows more runs: radio, drift",
    ):
        assert words in said
    assert "not explained" not in said
    small = budget_lines(budget(share(0.01)))[-1]
    assert small == "no cause is larger than an increment (0.0100 um)"


@pytest.mark.parametrize(
    ("left_um", "quantum_um", "words"),
    [
        (0.01, 0.0, None),
        (0.011, 0.0, "+0.0110 um are left with all causes off, more than an increment (0.0100 um)"),
        (-60.0, 50.0, "-60.0000 um are left with all causes off, more than the way in a cycle of"
         " the PLC and one of the CNC (50.0000 um)"),
        (-50.0, 50.0, None),
        (0.02, 0.01, "+0.0200 um are left with all causes off, more than an increment (0.0100 um)"),
    ],
)  # fmt: skip
def test_what_is_not_explained(left_um: float, quantum_um: float, words: str | None) -> None:
    found = not_explained(budget(left_um=left_um, quantum_um=quantum_um))
    assert (found == "") is (words is None)
    assert words is None or f"not explained: {words}: something acts" in found


def test_the_table_of_a_budget() -> None:
    rows = budget_table(budget(share(-1.5, expected_um=-1.2), left_um=0.5, kept_on=("run-up",)))
    first, left = rows
    assert (first["run"], first["axis"], first["cause"]) == ("plan.row", "Z", "trigger")
    assert (first["alone_um"], first["in_turn_um"], first["closed_form_um"]) == (-0.5, -1.5, -1.2)
    assert first["differs_um"] == pytest.approx(-0.3)
    assert (left["cause"], left["in_turn_um"], left["alone_um"]) == (LEFT, 0.5, None)
    assert {row["frame_log_sha256"] for row in rows} == {"abc"}
    meaning = str(left["meaning"])
    assert meaning.startswith("not explained: +0.5000 um")
    assert meaning.endswith("; not switched off, as there is no value without: run-up")
    assert CYCLES.place == "cycles"


@pytest.mark.parametrize(
    ("form_of_line", "shift_ms"),
    [
        # Behind by two wires and what the first two slaves take: 100 + 30 + 4 + 5 ns
        ("line", -139e-6),
        # The frame is at 900 - 50 us of 1000; positions count as of 250 us, and are of 80 us
        ("assumed", (600 - 770) * 1e-3),
    ],
)
def test_how_much_later_a_position_of_a_line_is_than_its_stamp(
    form_of_line: str, shift_ms: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wires and slaves that all differ; the wire of the first and the last slave do not count."""
    act = next(cause for cause in causes() if cause.form == form_of_line)
    own = {"wire_ns": {"Z": 900, "X": 100, "terminal": 30},
           "slave_ns": {"Z": 4, "X": 5, "terminal": 700},
           act.key: {"Z": 250}, act.off: {"Z": 80}}  # fmt: skip
    table = SimpleNamespace(frame_us=900, shift_us=50, of=lambda name, slave: own[name][slave])
    monkeypatch.setattr(closed_forms, "segment_of", lambda *_: table)
    monkeypatch.setattr(closed_forms, "slaves_on", lambda *_: ["Z", "X", "terminal"])
    line = SimpleNamespace(axis={"Z": SimpleNamespace(segment="line")},
                           cycle=SimpleNamespace(period_us=1000))  # fmt: skip
    found = closed_forms.line_shift_ms(
        Active(act, "1", "", {}),
        SimpleNamespace(rig=line),
        "Z",  # type: ignore[arg-type]
    )
    assert found == pytest.approx(shift_ms)
