"""Limits of testplans/probe_reality.csv, recomputed from what each habit of a probe does.

A touch measures v t_d and its pre-travel short of the contact; what it draws is drawn again here,
from its seed, with whole numbers. Nothing of the bench is imported. Lengths in um, v in mm/s.
"""

import csv
import math
import re
import statistics
import tomllib
from pathlib import Path
from typing import Any

import pytest
from scipy import stats

PLANS = Path(__file__).parents[2] / "testplans"
Q_UM = 10_000.0 / 2**20  # an increment: lead 10 mm, 20 bits
INPUT_MS = 0.004
MODULUS = 2**31 - 1
WIDE = 8.0  # as in test_statistics_bands.py: so many standard errors

with (PLANS / "probe_reality.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file)}


def _rig(name: str) -> dict[str, Any]:
    return tomllib.loads((PLANS / name).read_text(encoding="utf-8"))


REAL = _rig("rigs/probe-z-real.toml")["plant"]


def _value(row: dict[str, str], name: str, usual: float = 0.0) -> float:
    """A value of the plant that the row sets."""
    found = re.search(rf"(?:^|;; )plant:{re.escape(name)}=(\S+)", row["inputs"])
    return usual if found is None else float(found[1])


def _numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", text)]


def _check(row: dict[str, str], check: str) -> str:
    """The condition of a statistic in the cell `checks`."""
    (found,) = re.findall(rf"(?:^|;; ){re.escape(check)} = (.*?)(?: ;;|$)", row["checks"])
    return str(found)


def _v_mm_s(row: dict[str, str]) -> float:
    return float(row["plc:V.E.FEED"]) / 60.0


def _drawn(row: dict[str, str]) -> list[float]:
    """Pre-travel of each touch, from the seed: Box and Muller of two congruential sequences."""
    seed, found = int(_value(row, "probe.seed", 1)), []
    radius = 1 + 1226874159 * seed % (MODULUS - 1)
    angle = 1 + 62089911 * seed % (MODULUS - 1)
    for number in range(int(row["plc:V.E.TOUCHES"])):
        radius, angle = 48271 * radius % MODULUS, 69621 * angle % MODULUS
        normal = math.sqrt(-2 * math.log(radius / MODULUS)) * math.cos(math.tau * angle / MODULUS)
        first = _value(row, "probe.first_touch_um") if number == 0 else 0.0
        found.append(
            _value(row, "probe.pretravel_um")
            + _value(row, "probe.pretravel_scatter_um") * normal
            + _value(row, "probe.drift_um") * number
            + first
        )
    return found


@pytest.mark.parametrize("case", ["noise-4", "noise-33"])
def test_2_s_is_as_put_in_within_the_bounds_of_chi_square(case: str) -> None:
    row, n = ROWS[case], int(ROWS[case]["plc:V.E.TOUCHES"])
    put_in = _value(row, "probe.pretravel_scatter_um")
    assert f"2 s = {2 * put_in:g} um" in row["title"]
    if case == "noise-4":
        assert n == 50
        assert _check(row, f"spread_p(latch_error_um; {put_in:g})") == "> 0.01"
        assert _check(row, f"spread_p(latch_error_um; {2 * put_in:g})") == "< 0.001"
    else:  # 2 s, as for 20 touches in statistics.csv
        assert (n, _numbers(row["check:spread(latch_error_um)"])) == (20, [2 * put_in])
    low, high = (put_in * (stats.chi2.ppf(p, n - 1) / (n - 1)) ** 0.5 for p in (0.005, 0.995))
    drawn = _drawn(row)
    assert low < statistics.stdev(drawn) < high
    assert min(drawn) > 0.0  # nothing is cut off
    mean = _value(row, "probe.pretravel_um") + _v_mm_s(row) * INPUT_MS
    wide = WIDE * put_in / n**0.5
    assert _numbers(row["check:mean(latch_error_um)"]) == [-round(mean, 2), round(wide, 2)]


def test_the_first_touch_is_far_outside_what_the_others_do() -> None:
    """Half of what the draws of the seed give: |x1 - m| / (t s sqrt(1 + 1/(n - 1)))."""

    def apart(drawn: list[float]) -> float:
        others = drawn[1:]
        t = stats.t.ppf(0.975, len(others) - 1)
        width = t * statistics.stdev(others) * (1 + 1 / len(others)) ** 0.5
        return float(abs(drawn[0] - statistics.fmean(others)) / width)

    (least,) = _numbers(_check(ROWS["first-touch"], "first_sample(latch_error_um)"))
    assert apart(_drawn(ROWS["first-touch"])) > 2 * least
    (most,) = _numbers(_check(ROWS["first-touch-none"], "first_sample(latch_error_um)"))
    assert apart(_drawn(ROWS["first-touch-none"])) < most


def test_the_drift_is_that_of_the_probe() -> None:
    row, n = ROWS["drift"], int(ROWS["drift"]["plc:V.E.TOUCHES"])
    of_slope = _value(row, "probe.pretravel_scatter_um") / (n * (n**2 - 1) / 12.0) ** 0.5
    wanted = [-_value(row, "probe.drift_um"), round(WIDE * of_slope, 3)]
    assert _numbers(_check(row, "drift(latch_error_um)")) == wanted


@pytest.mark.parametrize("case", ["ideal", "bounce", "bounce-filter"])
def test_a_bouncing_signal_costs_what_the_input_filter_makes_of_it(case: str) -> None:
    """The first edge; with a filter above the interval, the edge after which the level rests."""
    row, late_ms = ROWS[case], INPUT_MS
    if case == "bounce-filter":
        (filter_us,) = _numbers(row["inputs"].rpartition("input_filter_us=")[2])
        interval = _value(row, "probe.bounce_time_ms") / (2 * _value(row, "probe.bounce_count"))
        assert interval < filter_us / 1e3
        late_ms += _value(row, "probe.bounce_time_ms") + filter_us / 1e3
    middle, width = _numbers(row["check:latch_error_um"].replace("+- ", ""))
    assert middle == pytest.approx(-_v_mm_s(row) * late_ms, abs=5e-5)
    assert Q_UM > width > 0.99 * Q_UM


def test_radio_is_a_delay_with_an_even_distribution() -> None:
    row, n = ROWS["radio-jitter"], int(ROWS["radio-jitter"]["plc:V.E.TOUCHES"])
    v, jitter_ms = _v_mm_s(row), _value(row, "probe.radio_jitter_us") / 1e3
    mean, s = v * (_value(row, "probe.radio_delay_ms") + INPUT_MS), v * jitter_ms / 3.0**0.5
    wanted = [-round(mean, 2), round(WIDE * s / n**0.5, 2)]
    assert _numbers(row["check:mean(latch_error_um)"]) == wanted
    assert _numbers(row["check:spread(latch_error_um)"]) == [round(2 * s, 2)]
    assert _numbers(row["check:range(latch_error_um)"]) == [round(2 * v * jitter_ms + Q_UM, 2)]


def test_a_three_leg_seat_yields_by_its_direction() -> None:
    """Moments about the line through two pads: F = F_p R / (2 L cos); F over the stiffness."""
    row = ROWS["lobing"]
    force, radius, length, bending_n_um = _value(row, "probe.seat_force_n"), 10.0, 50.0, 0.2
    angles = _numbers(row["inputs"].rpartition("seat_angle_deg=")[2])
    *errors, width = _numbers(row["check:latch_error_um"].replace("+-", ""))
    assert width == 0.0095
    for angle, error in zip(angles, errors, strict=True):
        nearest = max(math.cos(math.radians(angle + pad)) for pad in (0, 120, 240))
        pretravel = force * radius / (2 * length * nearest) / bending_n_um
        assert error == pytest.approx(-pretravel - _v_mm_s(row) * INPUT_MS, abs=5e-5)


def _twist_um(v: float) -> float:
    """LuGre friction in steady sliding over the stiffness of the screw: the defaults of both."""
    force = 120 + (160 - 120) * math.exp(-((v / 5.0) ** 2)) + 0.8 * v
    return force / 120.0


@pytest.mark.parametrize("case", ["friction", "friction-20um"])
def test_friction_twists_the_screw_and_backlash_adds_its_half(case: str) -> None:
    row = ROWS[case]
    half = _value(row, "z.backlash_um") / 2
    feeds = [feed / 60 for feed in _numbers(row["plc:V.E.FEED"])]
    *errors, width = _numbers(row["check:latch_error_um"].replace("+-", ""))
    assert width == 0.0095
    for v, error in zip(feeds, errors, strict=True):
        assert error == pytest.approx(-_twist_um(v) - half - v * INPUT_MS, abs=5e-5)


def test_what_a_real_machine_shows_is_the_sum() -> None:
    row, probe, n = ROWS["real"], REAL["probe"]["start"], int(ROWS["real"]["plc:V.E.TOUCHES"])
    v, jitter_ms = _v_mm_s(row), probe["radio_jitter_us"] / 1e3
    series = [probe["drift_um"] * k + probe["first_touch_um"] * (k == 0) for k in range(n)]
    mean = (
        probe["pretravel_um"]
        + v * (probe["radio_delay_ms"] + INPUT_MS)
        + REAL["z"]["start"]["backlash_um"] / 2
        + _twist_um(v)
        + statistics.fmean(series)
    )
    variance = probe["pretravel_scatter_um"] ** 2 + (v * jitter_ms) ** 2 / 3
    s = math.sqrt(variance + statistics.pvariance(series))
    found = _numbers(row["check:mean(latch_error_um)"])
    assert found == [-round(mean, 2), pytest.approx(WIDE * s / n**0.5, rel=0.05)]
    assert _numbers(row["check:range(latch_error_um)"])[0] == pytest.approx(8 * s, rel=0.05)
