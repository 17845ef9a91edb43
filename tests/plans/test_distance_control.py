"""Every limit of testplans/distance_control.csv from the formulas of `distance_law` and the walk.

So no band can grow unnoticed: a limit is the formula rounded to the digits that are printed, with
the width that stands here.
"""

import math

import numpy as np
import pytest
from tests.plans.distance_bands import (
    AFTER,
    BEHIND,
    DEAD,
    ERROR,
    EXPECTED,
    EXPECTED_DEAD,
    GROWTH,
    LIMIT,
    NOISE,
    OVERSHOOT,
    SETTLING,
    SINE,
    STABILITY,
    TIME_DEAD,
    dead_of,
    lifted,
    noise_band,
    ramp_bands,
    sine_band,
    stability_bands,
)
from tests.plans.distance_law import BOTH, CONST, SURFACE, Setup, rows
from tests.plans.distance_walk import GAP, alarm, settled, walk, wanted

ROWS = {name: Setup(row) for name, row in rows().items()}
TAGS = {
    "dead-time", "stability", "ramp", "sine", "step", "deadbeat", "settling", "clamps", "slope",
    "law", "weight", "adaptive", "alarm", "jump", "range", "deviation", "lost", "touch", "sign",
    "freeze", "off", "waits", "moves", "noise", "profile", "edge", "hole", "waviness", "servo",
    "variable", "plc", "hold", "objects", "set-dist", "default", "skew", "both", "surface", "pid",
    "filter",
}  # fmt: skip
AXIS_A = 1000.0  # P-AXIS-00008 while the list does not set it
LATE = "check:distance_alarm_late_cycles"


def having(column: str) -> list[str]:
    return [name for name, setup in ROWS.items() if setup.row.get(column)]


def ends(text: str) -> tuple[float, float]:
    low, high = text.split(" .. ")
    return float(low), float(high)


def is_band(text: str, middle: float, width: float, digits: int) -> bool:
    """Whether a band is middle -+ width, rounded."""
    low, high = ends(text)
    half = 0.5000001 * 10**-digits
    return abs(low - (middle - width)) <= half and abs(high - (middle + width)) <= half


def test_more_than_a_hundred_and_twenty_cases() -> None:
    assert len(ROWS) >= 120
    assert {setup.mode for setup in ROWS.values()} == {CONST, BOTH, SURFACE}
    assert {setup.n + setup.age for setup in ROWS.values()} >= {1, 2, 3, 4}
    words = {word for setup in ROWS.values() for word in setup.row["tags"].split()}
    assert words >= TAGS
    kinds = {setup.word("filter_type") for setup in ROWS.values()}
    assert kinds == {
        "MOVING_AVERAGE", "DEFAULT", "EXPO_MEAN", "LOWPASS", "KALMAN_MA", "KALMAN_EXPO",
    }  # fmt: skip


# Dead time


@pytest.mark.parametrize("case", having(DEAD))
def test_dead_cycles(case: str) -> None:
    setup = ROWS[case]
    dead = dead_of(setup)
    assert setup.row[DEAD] == f"== {dead}"
    assert setup.row[EXPECTED_DEAD] == f"== {dead}"
    wanted = setup.row.get(TIME_DEAD)
    assert not wanted or wanted == f"{(dead + 1) * setup.T * 1e3:g} +- 0.05"


def test_dead_time_of_every_kind_of_rig() -> None:
    rigs = {ROWS[name].row["rig"].removeprefix("rigs/distance-z") for name in having(DEAD)}
    assert rigs == {
        ".toml", "-2ms.toml", "-500k.toml", "-event.toml", "-every-second.toml",
        "-variable.toml", "-variable-late.toml",
    }  # fmt: skip


# Stability


@pytest.mark.long(but=1)
@pytest.mark.parametrize("case", having(LIMIT))
def test_limit_of_kp_and_growth(case: str) -> None:
    setup = ROWS[case]
    bands = stability_bands(setup)
    (limit, _), (growth, _) = bands[LIMIT], bands[EXPECTED]
    assert is_band(setup.row[LIMIT], *bands[LIMIT], 4)
    if setup.row.get(EXPECTED):  # equal poles of a low-pass are not known to so many digits
        assert is_band(setup.row[EXPECTED], *bands[EXPECTED], 5)
    word = "stable" if growth < 1 else "unstable"
    assert setup.row[STABILITY] == f"== {word}"
    if setup.row.get(GROWTH):
        assert is_band(setup.row[GROWTH], *bands[GROWTH], 5)
    if case.endswith("-below"):
        assert 0.965 * limit < setup.kp < limit
    if case.endswith("-above"):
        assert limit < setup.kp < 1.035 * limit


@pytest.mark.long(but=1)
@pytest.mark.parametrize("case", [name for name in having(LIMIT) if "-above" in name])
def test_each_limit_is_met_from_both_sides(case: str) -> None:
    below = ROWS[case.replace("-above", "-below")]
    assert below.limit == pytest.approx(ROWS[case].limit)
    assert (below.mode, below.n, below.age) == (ROWS[case].mode, ROWS[case].n, ROWS[case].age)


@pytest.mark.parametrize("case", having(LIMIT))
def test_poles_against_the_closed_form_of_a_mean(case: str) -> None:
    """2 N sin²(w/2)/sin(N w/2), w = pi/(N + 2n): CONST_DIST, and n of Z_com with both encoders."""
    setup = ROWS[case]
    above, below = setup.filter
    is_mean = len(below) == 1 and np.ptp(above) == 0.0
    if setup.g or setup.r or not is_mean:
        return
    n = setup.n + setup.age
    if setup.mode == SURFACE:
        if not setup.age:
            assert setup.limit == pytest.approx(2.0)
        return
    if setup.mode == BOTH:
        n = setup.n - 1
    count = len(above)
    w = math.pi / (count + 2 * n)
    closed = 2 * count * math.sin(w / 2) ** 2 / math.sin(count * w / 2)
    assert setup.limit == pytest.approx(min(closed, 2.0), rel=1e-6)


def test_the_defaults_are_unstable_and_set_pos_is_not() -> None:
    defaults = [setup for name, setup in ROWS.items() if name.startswith("default-const")]
    assert {(setup.kp, setup.count, setup.n) for setup in defaults} == {(1.0, 4, 1), (1.0, 4, 2)}
    assert all(setup.growth(1.0) > 1 for setup in defaults)
    surface = [setup for name, setup in ROWS.items() if name.startswith("surface-1.0")]
    assert len(surface) == 6
    assert all(setup.growth(1.0) < 1 for setup in surface)


# Ramps, sines, noise


@pytest.mark.parametrize("case", having(ERROR))
def test_error_on_a_ramp(case: str) -> None:
    row, bands = ROWS[case].row, ramp_bands(ROWS[case])
    assert is_band(row[ERROR], *bands[ERROR], 3)
    if row.get(BEHIND):
        assert is_band(row[BEHIND], *bands[BEHIND], 3)


@pytest.mark.parametrize("case", having(SINE))
def test_sine(case: str) -> None:
    assert is_band(ROWS[case].row[SINE], *sine_band(ROWS[case]), 4)


@pytest.mark.parametrize("case", having(NOISE))
def test_noise_of_the_offset(case: str) -> None:
    assert is_band(ROWS[case].row[NOISE], *noise_band(ROWS[case]), 4)


# Steps and limits


@pytest.mark.long(but=1)
@pytest.mark.parametrize("case", [*having(SETTLING), *having(OVERSHOOT)])
def test_step(case: str) -> None:
    """Settling to the cycle; overshoot to an increment of the sensor, 10 % with a real drive."""
    setup = ROWS[case]
    assert setup.row["plant:gap.lift_begin_ms"] == setup.row["plant:gap.lift_end_ms"]
    time, beyond = settled(walk(setup, lifted(setup)), GAP)
    text = setup.row.get(OVERSHOOT)
    if setup.drive_lag and text:
        low, high = _limits(text)
        assert low <= beyond <= high
        return
    if setup.row.get(SETTLING):
        assert setup.row[SETTLING] == f"== {time}"
    if text and "+-" in text:
        middle, width = text.split(" +- ")
        assert float(middle) == pytest.approx(beyond, abs=2e-5)
        assert width == "0.00005"
    elif text:
        assert text == "<= 0.0001"
        assert beyond < 1e-4


def _limits(text: str) -> tuple[float, float]:
    return ends(text) if ".." in text else (0.0, float(text.removeprefix("<= ")))


@pytest.mark.parametrize("case", [name for name in ROWS if name.startswith("clamps-")])
def test_clamps_are_reached_and_never_passed(case: str) -> None:
    setup = ROWS[case]
    v = setup.listed("v_max") * 1e-3
    down = v * (setup.listed("v_weight_down") / 1000 or 1)
    is_down = setup.number("plant:gap.lift_mm") < 0
    answer = setup.row.get("check:offset_speed_mm_s_max")
    assert not answer or answer == f"{down if is_down else v:g} +- 0.000001"
    answer = setup.row.get("check:offset_speed_down_mm_s_max")
    assert not answer or answer == f"{down:g} +- 0.000001"
    answer = setup.row.get("check:offset_acceleration_mm_s2_max")
    if answer:
        a = setup.listed("a_max") or AXIS_A
        if setup.listed("use_adaptive_acceleration"):
            low, high = (setup.listed(f"dist_error_a_{end}") * 1e-4 for end in ("min", "max"))
            share = (abs(setup.number("plant:gap.lift_mm")) - low) / (high - low)
            a = setup.listed("a_min") + (a - setup.listed("a_min")) * min(share, 1.0)
        assert float(answer.split(" +- ")[0]) == pytest.approx(a)


def test_overshoot_of_the_manuals_sample_set() -> None:
    """v²/2a - v/K + a/2K² = 0.467 mm, K = kp/T; one cycle of the way for the sampling."""
    row = ROWS["clamps-surface"]
    v, a, gain = row.listed("v_max") * 1e-3, row.listed("a_max"), row.kp / row.T
    closed = v * v / (2 * a) - v / gain + a / (2 * gain * gain)
    answer = float(row.row[OVERSHOOT].split(" +- ")[0])
    assert closed == pytest.approx(0.467, abs=1e-3)
    assert answer == pytest.approx(closed, abs=v * row.T)


# Alarms


@pytest.mark.long
@pytest.mark.parametrize("case", having(AFTER))
def test_cycle_of_an_alarm_that_a_wrong_sign_or_the_defaults_bring(case: str) -> None:
    setup = ROWS[case]
    found = alarm(setup, walk(setup, np.zeros(4000)))
    assert found is not None
    number, cycle = found
    assert setup.row["check:alarms"] == f"== {number}"
    assert setup.row[AFTER] == f"== {cycle}"


@pytest.mark.long
@pytest.mark.parametrize("case", [name for name in ROWS if name.startswith("sign-")])
def test_only_documented_signs_converge(case: str) -> None:
    """The other half ends in 70330 or 70331."""
    setup = ROWS[case]
    if setup.sign == 1:
        assert setup.row[STABILITY] == "== stable"
        assert alarm(setup, walk(setup, np.zeros(1000))) is None
    else:
        assert setup.growth(setup.kp) > 1
        assert setup.row["check:alarms"] in ("== 70330", "== 70331")


def test_every_mode_has_every_sign() -> None:
    signs = [setup for name, setup in ROWS.items() if name.startswith("sign-")]
    kinds = {
        (setup.mode, "SENSOR_VAR" in setup.program, setup.sign, wanted(setup) is not None)
        for setup in signs
    }
    assert len(kinds) == 12


@pytest.mark.parametrize("case", having(LATE))
def test_no_alarm_is_late(case: str) -> None:
    assert ROWS[case].row[LATE] == "== 0"
    assert ROWS[case].row["check:alarms"] != "none"


@pytest.mark.parametrize(
    ("case", "rate_um_s"),
    [
        ("jump-beyond", 20_000), ("jump-within", 20_000), ("jump-newer", 20_000),
        ("rapid-5000", 166_667), ("rapid-170000", 166_667),
        ("rapid-default", 4_833), ("rapid-default-beyond", 5_167),
    ],
)  # fmt: skip
def test_00417_counts_in_um_per_second(case: str, rate_um_s: float) -> None:
    """A step in one cycle of 1 ms, or Z with the feed of the row."""
    setup = ROWS[case]
    feed = setup.number("plc:V.E.FEED") / 60 * 1e3
    rate = feed or setup.number("plant:gap.lift_mm") / setup.T * 1e3
    assert rate == pytest.approx(rate_um_s, rel=1e-3)
    is_beyond = rate > setup.listed("max_act_value_change")
    number = "310018" if "newer" in case else "70329"
    assert setup.row["check:alarms"] == (f"== {number}" if is_beyond else "none")


@pytest.mark.parametrize("case", [name for name in ROWS if name.startswith(("touch", "tolerance"))])
def test_range_of_the_sensor(case: str) -> None:
    """s = -gap leaves [min + tolerance, max - tolerance] upwards; the limit itself is allowed."""
    setup = ROWS[case]
    nearest = round((GAP - setup.number("plant:gap.lift_mm")) / setup.increment)
    highest = (setup.listed("max_pos") - setup.listed("tolerance")) * 1e-4
    is_beyond = -nearest > round(highest / setup.increment)
    assert setup.row["check:alarms"] == ("== 70330" if is_beyond else "none")


def test_rows_at_a_limit_itself() -> None:
    """Of the tolerance and of max_deviation; an increment of the sensor beyond it is too much."""
    at, beyond = ROWS["tolerance-at"], ROWS["tolerance-at-beyond"]
    allowed = (at.listed("tolerance") - at.listed("max_pos")) * 1e-4
    assert allowed == pytest.approx(GAP - at.number("plant:gap.lift_mm"), abs=1e-9)
    more = beyond.number("plant:gap.lift_mm") - at.number("plant:gap.lift_mm")
    assert more == pytest.approx(at.increment)
    within = ROWS["deviation-within"]
    assert within.listed("max_deviation") * 1e-4 == within.number("plant:gap.lift_mm")


def test_a_filter_that_went_on_during_freeze_gives_the_whole_step() -> None:
    """First step behind FREEZE: kp times what the surface has risen, in one cycle of T."""
    setup = ROWS["freeze-filter"]
    assert setup.number("plant:gap.lift_end_ms") + setup.count < 100 + 1e3 * setup.number(
        "plc:V.E.TIME"
    ), "the window is full of the new surface when control is switched on again"
    speed = setup.kp * setup.number("plant:gap.lift_mm") / setup.T
    assert setup.row["check:offset_speed_mm_s_max"] == f"{speed:g} +- 0.01"
    assert setup.row["check:offset_acceleration_mm_s2_max"] == f"{speed / setup.T:g} +- 10"
    assert setup.listed("v_max") * 1e-3 > speed
    assert setup.listed("a_max") > speed / setup.T


def test_what_is_checked_in_every_row() -> None:
    """Checks without a number of their own: nothing moves, nothing is left, the second model."""
    zero = {"check:freeze_drift_um", "check:offset_held_drift_um", "check:offset_end_mm", LATE}
    for name, setup in ROWS.items():
        for column in zero:
            assert setup.row.get(column, "") in ("", "== 0"), (name, column)
        model = setup.row.get("check:offset_model_error_um", "")
        assert model in ("", "<= 0.001"), name
