"""Limits of testplans/slope.csv from closed forms; nothing of the bench is imported.

A stop with equal ramps t from v is v²/2a + v t/2, below a t it is v sqrt(v t/a). What acts comes
from the first table of FCT-C4 2.1 and from the list of the rig, read here as text.
"""

import csv
import math
import re
import tomllib
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
LIST = (PLANS / "rigs" / "lists" / "axis-z-slope.lst").read_text(encoding="utf-8")
PERIOD_S, INPUT_S, KV = 1e-3, 4e-6, 40.0


def _rows() -> dict[str, dict[str, str]]:
    with (PLANS / "slope.csv").open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


ROWS = _rows()
TAGGED = {
    tag: [name for name, row in ROWS.items() if tag in row["tags"].split()]
    for tag in (
        "moving",
        "table",
        "target",
        "ramp-time",
        "stop",
        "in-ramp",
        "weights",
        "stroke",
        "run-up",
        "last-ramp",
        "sin2-run-up",
        "hold",
    )
}


def _value(row: dict[str, str], name: str) -> float:
    """A value of the list, or of the row; ramp times in s."""
    written = row.get(f"set:Z.getriebe[0].slope_profil.{name}")
    if not written:
        match = re.search(rf"^getriebe\[0\]\.slope_profil\.{name}\s+(\d+)", LIST, re.M)
        assert match is not None
        written = match[1]
    return float(written) / (1e6 if name.startswith("tr_") else 1.0)


def _flags(row: dict[str, str]) -> tuple[bool, bool, bool]:
    names = ("meas_use_std_dynamic", "meas_deceleration_mode", "use_drive_curr_limit")
    std, mode, limit = (row[f"set:channel.{name}"] == "1" for name in names)
    return std, mode, limit


def _stop(row: dict[str, str]) -> tuple[float, float]:
    """Deceleration and ramp time after the signal."""
    std, mode, limit = _flags(row)
    kind = "feedh" if std or (limit and not mode) else "grenz"
    return _value(row, f"a_{kind}"), _value(row, f"tr_{kind}")


def _run_up(row: dict[str, str]) -> tuple[float, float, float]:
    """Acceleration, rise and fall."""
    if _flags(row)[0]:
        names = ("a_beschl", "tr_beschl_zu", "tr_beschl_ab")
    else:
        names = ("a_grenz", "tr_grenz", "tr_grenz")
    a, rise, fall = (_value(row, name) for name in names)
    return a, rise, fall


def way(v: float, a: float, t: float) -> float:
    return v * v / (2 * a) + v * t / 2 if v >= a * t else v * math.sqrt(v * t / a)


def _is(text: str, value: float) -> bool:
    """Whether a number of the plan is this one to its last digit."""
    digits = len(text.partition(".")[2])
    return abs(float(text) - value) <= 0.5 * 10**-digits * (1 + 1e-9)


def _exact(cell: str, value: float, width: float) -> bool:
    number, _, band = cell.partition(" +- ")
    return _is(number, value) and float(band) == width


def test_the_plan_has_the_cases_that_it_is_about() -> None:
    settings = [tuple(map(int, _flags(ROWS[name]))) for name in ROWS if name.startswith("row-")]
    assert settings == [(0, 0, 0), (0, 0, 1), (0, 1, 0), (0, 1, 1), (1, 0, 0), (1, 1, 1)]
    values = [_value(ROWS["row-000"], n) for n in ("a_beschl", "a_brems", "a_grenz", "a_feedh")]
    assert len(set(values)) == 4
    rig = tomllib.loads((PLANS / "rigs" / "probe-z.toml").read_text(encoding="utf-8"))
    assert rig["plant"]["z"]["start"]["kv"] == KV
    assert rig["drive"]["servo"]["input_delay_us"] == INPUT_S * 1e6


AT_FEED = [name for name, row in ROWS.items() if row["check:overtravel_mm"] and row["plc:V.E.FEED"]]


@pytest.mark.parametrize("case", AT_FEED)
def test_stop_and_overtravel_at_constant_speed(case: str) -> None:
    """The way of the set position is that of the ramps alone; v (t_d + U T) + v/Kv come on top."""
    row = ROWS[case]
    v = float(row["plc:V.E.FEED"]) / 60.0
    stop_mm = way(v, *_stop(row))
    assert _exact(row["check:stop_way_mm"], stop_mm, 0.00001)
    low, high = row["check:overtravel_mm"].split(" .. ")
    least = v * (INPUT_S + PERIOD_S) + stop_mm + v / KV
    assert _is(low, least)
    assert _is(high, least + v * PERIOD_S)
    assert _exact(row["check:velocity_mm_s_max"], v, 0.001)
    assert _exact(row["check:contact_velocity_mm_s"], -v, 0.001)
    assert row["check:alarms"] == "none"


OF_TABLE = [n for n in (*TAGGED["table"], *TAGGED["stop"]) if n not in TAGGED["ramp-time"]]


@pytest.mark.parametrize("case", TAGGED["in-ramp"])
def test_what_comes_in_a_ramp_changes_neither_its_acceleration_nor_the_stop(case: str) -> None:
    row = ROWS[case]
    assert _exact(row["check:set_acceleration_mm_s2_max"], _run_up(row)[0], 0.001)
    assert _exact(row["check:stop_way_mm"], way(60.0, *_stop(row)), 0.00001)


@pytest.mark.parametrize("case", TAGGED["moving"])
def test_an_override_that_moves_passes_no_limit(case: str) -> None:
    """Speed of the feed and acceleration of the run-up are bounds; it stops from 48 mm/s."""
    row = ROWS[case]
    acceleration = _run_up(row)[0]
    assert row["check:set_acceleration_mm_s2_max"] == f"<= {acceleration + 0.001:.3f}"
    assert row["check:velocity_mm_s_max"] == "<= 60.001"
    if case in TAGGED["stroke"]:
        assert row["check:stop_way_mm"] == "<= 5"  # the stroke of the probe
        return
    assert _exact(row["check:stop_way_mm"], way(48.0, *_stop(row)), 0.00001)


@pytest.mark.parametrize("case", OF_TABLE)
def test_accelerations_and_jerk_are_those_of_the_table(case: str) -> None:
    """Both have parts of more than three cycles at 60 mm/s: differences read them exactly."""
    row = ROWS[case]
    (a, rise, fall), (d, stop) = _run_up(row), _stop(row)
    if case in TAGGED["target"]:
        kind = ("a_brems", "tr_brems_zu") if _flags(row)[0] else ("a_grenz", "tr_grenz")
        d, stop = _value(row, kind[0]), _value(row, kind[1])
    assert 60.0 / a - (rise + fall) / 2 > 2 * PERIOD_S
    assert _exact(row["check:set_acceleration_mm_s2_max"], a, 0.001)
    assert _exact(row["check:set_deceleration_mm_s2_max"], d, 0.001)
    if row["set:channel.prog_start.slope.profile"] == "1":
        jerk = max(a / rise, a / fall, d / stop)
        assert _exact(row["check:set_jerk_mm_s3_max"], jerk, 1.0)


@pytest.mark.parametrize("case", TAGGED["ramp-time"])
def test_a_small_change_of_speed_keeps_its_jerk_or_its_ramp_time(case: str) -> None:
    """The peak lies between two cycles: less than (j1 + j2) T/6 + j T/2 of it is not seen."""
    row = ROWS[case]
    v, (a, rise, fall) = float(row["plc:V.E.FEED"]) / 60.0, _run_up(row)
    if row["set:channel.prog_start.slope.mode_ramp_time"] == "1":
        peak = v / ((rise + fall) / 2)
        jerks = peak / rise, peak / fall
    else:
        peak = math.sqrt(2 * v / ((rise + fall) / a))
        jerks = a / rise, a / fall
    low, high = row["check:set_acceleration_mm_s2_max"].split(" .. ")
    assert _is(high, peak)
    assert _is(low, peak - sum(jerks) * PERIOD_S / 6 - max(jerks) * PERIOD_S / 2)
    assert _exact(row["check:stop_way_mm"], way(v, *_stop(row)), 0.00001)


def test_the_path_s_own_ramps_crush_a_probe() -> None:
    """3.300 mm against 0.690 mm from the same speed."""
    by_path, own = (way(60.0, *_stop(ROWS[f"stop-{name}"])) for name in ("path", "own"))
    assert (by_path, own) == pytest.approx((3.3, 0.69))


@pytest.mark.parametrize("case", TAGGED["weights"])
def test_weights_act_with_p_chan_00296_and_never_on_the_stop(case: str) -> None:
    row = ROWS[case]
    a = _run_up(row)[0] * (0.5 if _flags(row)[0] else 1.0)
    assert _exact(row["check:set_acceleration_mm_s2_max"], a, 0.001)
    assert _exact(row["check:set_deceleration_mm_s2_max"], _stop(row)[0], 0.001)


@pytest.mark.parametrize("case", TAGGED["hold"])
def test_a_feedhold_is_by_p_chan_00097_alone(case: str) -> None:
    """P-CHAN-00214 lets the signal brake with rapid values, so that each is seen."""
    row = ROWS[case]
    kind = "feedh" if _flags(row)[2] else "grenz"
    held = _value(row, f"a_{kind}"), _value(row, f"tr_{kind}")
    assert _stop(row) == (1000.0, 0.025)
    assert _exact(row["check:set_deceleration_mm_s2_max"], held[0], 0.001)
    assert _exact(row["check:set_jerk_mm_s3_max"], held[0] / held[1], 1.0)


def _stop_from(v: float, u: float, a: float, t: float) -> float:
    """Way of a stop that begins with an acceleration u, which falls within u t/a first."""
    fall = u * t / a
    return v * fall + u * fall * fall / 3 + way(v + u * fall / 2, a, t)


IN_RUN_UP = (*TAGGED["run-up"], *TAGGED["last-ramp"], *TAGGED["sin2-run-up"])
AT_STROKE = [name for name in TAGGED["stroke"] if name not in IN_RUN_UP]


@pytest.mark.parametrize("case", AT_STROKE)
def test_the_speed_that_a_stroke_allows(case: str) -> None:
    """a (-t/2 + sqrt(t²/4 + 2H/a)), and the stop from it takes the whole stroke."""
    row, stroke_mm = ROWS[case], 5.0
    a, t = _stop(row)
    v = float(row["check:velocity_mm_s_max"].partition(" ")[0])
    assert v == pytest.approx(a * (-t / 2 + math.sqrt(t * t / 4 + 2 * stroke_mm / a)), abs=6e-4)
    number, _, width = row["check:stop_way_mm"].partition(" +- ")
    assert float(number) == pytest.approx(way(v, a, t), abs=5e-4) == pytest.approx(5.0, abs=5e-4)
    assert (width, row["check:alarms"]) == ("0.0005", "== 900222")


@pytest.mark.parametrize("case", TAGGED["run-up"])
def test_a_signal_in_the_run_up_stops_inside_the_stroke(case: str) -> None:
    """It is in the cycle between 1 and 4.2 ms after the contact, of an axis without lag."""
    row = ROWS[case]
    ramps = re.search(r"stroke-(\d+)-run-up", case)
    assert ramps is not None
    v = float(ROWS[f"stroke-{ramps[1]}"]["check:velocity_mm_s_max"].partition(" ")[0])
    a, t, _ = _run_up(row)
    begin_mm = float(row["plant:z.position_start_mm"]) - 100.0
    step = 1e-5
    ways, s, now, u, at = [], 0.0, 0.0, 0.0, 0.0
    met: float | None = None
    while now < v - 1e-3 and at < 0.3:
        left = v - now
        rate = -a / t if u * u * t / (2 * a) >= left else (a / t if u < a else 0.0)
        s, now = s + now * step + u * step * step / 2, now + u * step + rate * step * step / 2
        u, at = min(max(u + rate * step, 0.0), a), at + step
        met = at if met is None and s >= begin_mm else met
        if met is not None and met + 1.0e-3 <= at <= met + 4.2e-3:
            ways.append(_stop_from(now, u, *_stop(row)))
    low, high = map(float, row["check:stop_way_mm"].split(" .. "))
    assert high == 5.0
    assert low <= min(ways) + 1e-3
    assert min(ways) - low < 0.02
    assert max(ways) <= 5.0 + 2e-3  # steps of this sum


def _in_run_up(at: float, v: float, a: float, t: float) -> tuple[float, float, float]:
    """Way, speed and acceleration of a run-up to v >= a t with equal ramps t."""
    jerk, last = a / t, v / a
    if at < t:
        return jerk * at**3 / 6, jerk * at * at / 2, jerk * at
    if at < last:
        held = at - t
        return a * t * t / 6 + a * t / 2 * held + a * held**2 / 2, a * t / 2 + a * held, a
    left = max(last + t - at, 0.0)
    end = v * v / (2 * a) + v * t / 2 + v * max(at - last - t, 0.0)
    return end - v * left + jerk * left**3 / 6, v - jerk * left * left / 2, jerk * left


@pytest.mark.parametrize("case", TAGGED["last-ramp"])
def test_a_signal_where_the_last_ramp_of_a_run_up_would_begin_stops_inside_too(case: str) -> None:
    """Without regard to the stroke it would take H + v t - a t²/6 at most (v >= a t/2).

    That is the way of a stop whose signal comes at the begin of the last ramp.
    In that ramp u = a x/t and the speed is v - u² t/2a, so that a stop takes v x - a x³/6t more
    than one from v; before it the same acceleration falls from a smaller speed. The signal is in
    the cycle between 1 and 4.2 ms after the contact, and that begin is among those instants.
    """
    row, stroke_mm = ROWS[case], 5.0
    a, t = _stop(row)
    assert _run_up(row) == (a, t, t)
    v = a * (-t / 2 + math.sqrt(t * t / 4 + 2 * stroke_mm / a))
    contact_mm = float(row["plant:z.position_start_mm"]) - 100.0
    low, high = 0.0, v / a + t
    for _ in range(60):
        middle = (low + high) / 2
        is_before = _in_run_up(middle, v, a, t)[0] < contact_mm
        low, high = (middle, high) if is_before else (low, middle)
    assert low + 1.0e-3 <= v / a <= low + 4.2e-3
    instants = (low + 1.0e-3 + k * 1e-5 for k in range(321))
    ways = [_stop_from(*_in_run_up(at, v, a, t)[1:], a, t) for at in instants]
    most = stroke_mm + v * t - a * t * t / 6
    assert max(ways) <= most + 1e-9
    assert max(ways) == pytest.approx(most, abs=1e-3)
    assert min(ways) > 1.1 * stroke_mm
    # Inside the stroke, and no more than 4 % of it is given away
    assert row["check:stop_way_mm"] == f"{0.96 * stroke_mm:g} .. {stroke_mm:g}"
    for name in TAGGED["sin2-run-up"]:
        assert ROWS[name]["check:stop_way_mm"] == f"<= {stroke_mm:g}"
