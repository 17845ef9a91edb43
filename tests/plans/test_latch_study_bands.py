"""Limits of the study of signal sources, recomputed from closed forms written out here.

Down at v: published less true position at the contact is -(p + v D), with the pre-travel p and the
delay D of the chain. So D is the slope over the true velocity and -p the intercept. Nothing of the
bench is imported: rigs and plan are read as the text files they are.

A check passes where its value is inside by more than twice its bound. So a limit of three times the
bound asks that the closed form is within the bound of 95 %.
"""

import csv
import math
import tomllib
from itertools import chain
from pathlib import Path
from typing import Any

import pytest
from scipy.stats import chi2, t

PLANS = Path(__file__).parents[2] / "testplans"
SYNC_MS = 0.048  # 44 bits and 4 stuff bits at 1 Mbit/s
LEAD_UM = 10_000.0


def _rows() -> dict[str, dict[str, str]]:
    """Rows with the defaults of the row `*`, its inputs before those of a row."""
    with (PLANS / "latch_study.csv").open(encoding="utf-8", newline="") as file:
        default, *rows = csv.DictReader(file)
    assert default["case"] == "*"
    found = {}
    for row in rows:
        whole = {key: row[key] or default[key] for key in row}
        whole["inputs"] = f"{default['inputs']} ;; {row['inputs']}"
        found[row["case"]] = whole
    return found


def _inputs(row: dict[str, str]) -> dict[str, str]:
    return dict(item.split("=", 1) for item in row["inputs"].split(" ;; "))


def _checks(row: dict[str, str]) -> dict[str, str]:
    """Conditions by metric, without the axis that they name."""
    found = {key[6:]: text for key, text in row.items() if key.startswith("check:") and text}
    for item in filter(None, row["checks"].split(" ;; ")):
        metric, _, rest = item.partition(")")
        found[f"{metric})"] = rest.strip().removeprefix("= ")
    return {metric.replace(":X", ""): text for metric, text in found.items()}


ROWS = _rows()
FIXED = ("drive", "stamp", "ext-probe")
AT_SIGNAL = tuple(case for case in ROWS if case not in FIXED)
VELOCITY, ERROR = "contact_velocity_mm_s", "latch_error_um"


def _rig(name: str) -> dict[str, Any]:
    path = PLANS / "rigs" / name
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    return _merged(_rig(table["base"]), table) if "base" in table else table


def _merged(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    found = dict(below)
    for key, value in above.items():
        both = isinstance(value, dict) and isinstance(found.get(key), dict)
        found[key] = _merged(found[key], value) if both else value
    return found


class Study:
    """What a row is about: its speeds, its chain and its increment."""

    def __init__(self, case: str) -> None:
        row = ROWS[case]
        self.inputs, self.checks = _inputs(row), _checks(row)
        self.rig = _rig(Path(row["rig"]).name)
        feeds = [float(text) for text in row["plc:V.E.FEED"].strip("[]").split("|")]
        is_oblique = row["program"].endswith("-xz.nc")  # X has 0.6 of the path
        self.speeds = [feed / 60.0 * (0.6 if is_oblique else 1.0) for feed in feeds]
        self.touches = int(self.inputs["plc:V.E.TOUCHES"])
        self.pretravel_um = float(self.inputs.get("plant:probe.pretravel_um", 0))
        self.increment_um = LEAD_UM / int(row["drive:servo.encoder_increments"])
        self.cnc_ms = self.rig["cycle"]["period_us"] / 1e3
        self.turn_ms = self.rig["cycle"]["cycle_offset_us"] / 1e3
        self.plc_ms = float(self.inputs.get("plc:period_us", 0)) / 1e3
        self.input_ms = float(self.inputs.get("plc:terminal.filter_us", 0)) / 1e3
        self.age_ms = self.turn_ms - SYNC_MS

    @property
    def mean_speed(self) -> float:
        return sum(self.speeds) / len(self.speeds)

    @property
    def away(self) -> list[float]:
        return [speed - self.mean_speed for speed in self.speeds]

    def line_bounds(self, spread_ms: float) -> tuple[float, float]:
        """Bounds of slope and intercept where each error is v times a delay with this spread."""
        n = self.touches * len(self.speeds)
        squares = self.touches * sum(away**2 for away in self.away)
        rest = sum(self.touches * (v * spread_ms) ** 2 for v in self.speeds) / (n - 2)
        slope = float(t.ppf(0.975, n - 2)) * math.sqrt(rest / squares)
        return slope, slope * math.sqrt(squares / n + self.mean_speed**2)


def _locked_ms(study: Study) -> float:
    """Input + T_plc/2 + hand-over less the age of the actual value."""
    hand_over = (study.turn_ms - study.rig["plc"]["offset_us"] / 1e3) % study.cnc_ms
    return study.input_ms + study.plc_ms / 2 + hand_over - study.age_ms


def _delay_ms(case: str, study: Study) -> float:
    """The mean from contact to the instant whose position is the value."""
    if case == "drive":
        return float(study.rig["drive"]["servo"]["input_delay_us"]) / 1e3
    if case == "stamp":
        return study.input_ms
    if case == "ext-probe":
        radio = float(study.inputs["plant:probe.radio_delay_ms"])
        return radio + float(study.rig["drive"]["servo"]["input_delay_us"]) / 1e3
    if case == "plc-sliding":
        return study.input_ms + study.plc_ms / 2 + study.cnc_ms / 2 - study.age_ms
    if case == "ext-position":  # the PLC sees what the NC cycle before it has taken over
        since = (study.rig["plc"]["offset_us"] / 1e3 - study.turn_ms) % study.cnc_ms
        return study.input_ms + study.plc_ms / 2 - since - study.age_ms
    return _locked_ms(study)


def _spread_ms(case: str, study: Study) -> float:
    """T_plc/sqrt(12), and with a phase that slides sqrt(T_plc^2 + T_cnc^2)/sqrt(12)."""
    return math.hypot(study.plc_ms, study.cnc_ms if case == "plc-sliding" else 0.0) / 12**0.5


def _numbers(text: str) -> list[tuple[float, float]]:
    """Middle and width of each condition of a cell, `<=` as a width around 0."""
    found = []
    for part in text.strip("[]").split(" | "):
        middle, _, width = part.partition(" +- ")
        is_limit = part.startswith("<= ")
        found.append((0.0, float(part[3:])) if is_limit else (float(middle), float(width)))
    return found


def test_every_source_is_there_at_three_feeds_and_fifty_phases() -> None:
    named = {ROWS[case]["set:Z.kenngr.measure.signal"] for case in ROWS}
    assert named == {
        *("DRIVE", "PLC", "PLC_TIMESTAMP", "PLC_FIRST_EVENT", "PLC_EXT_LATCH_CONTROL"),
        "EXT_PROBE_WITH_DRIVE",
    }
    for case, row in ROWS.items():
        study = Study(case)
        assert len(study.speeds) >= 3, case
        assert study.touches == 50, case
        assert study.checks[f"count({ERROR})"] == "== 150", case
        cycle = float(row["plc:V.E.CYCLE_MS"])
        assert cycle == (13.0 if case == "plc-sliding" else study.plc_ms or 1.0), case


@pytest.mark.parametrize("case", ROWS)
def test_every_edge_is_in_constant_feed(case: str) -> None:
    """A tenth of a percent: a tenth of what the slope may be off."""
    study = Study(case)
    means = _numbers(study.checks[f"mean({VELOCITY}; each)"])
    ranges = _numbers(study.checks[f"range({VELOCITY}; each)"])
    for speed, mean, (_, width) in zip(study.speeds, means, ranges, strict=True):
        assert mean == (pytest.approx(-speed, abs=1e-4),
                        pytest.approx(speed * 1e-3, abs=1e-4))  # fmt: skip
        assert width == pytest.approx(speed * 1e-3, abs=1e-4)


@pytest.mark.parametrize("case", ROWS)
def test_the_mean_at_each_feed_is_on_the_line(case: str) -> None:
    """Within an increment, at the PLC within the bound of a mean of so many values."""
    study = Study(case)
    delay, spread = _delay_ms(case, study), _spread_ms(case, study)
    of_mean = float(t.ppf(0.975, study.touches - 1)) / math.sqrt(study.touches)
    found = _numbers(study.checks[f"mean({ERROR}; each)"])
    for speed, (middle, width) in zip(study.speeds, found, strict=True):
        expected = -speed * delay - study.pretravel_um
        assert middle == pytest.approx(expected, abs=1e-3)
        bound = study.increment_um if case in FIXED else 3 * of_mean * speed * spread
        assert width == pytest.approx(bound, abs=1e-3 if case in AT_SIGNAL else 5e-5)


@pytest.mark.parametrize("case", ROWS)
def test_the_line_is_the_delay_of_the_chain_and_the_pre_travel(case: str) -> None:
    """1 % of the delay and what rounding can turn the line; at the PLC the bound of 95 %."""
    study = Study(case)
    ((slope, slope_width),) = _numbers(study.checks[f"slope({ERROR}; {VELOCITY})"])
    ((place, place_width),) = _numbers(study.checks[f"intercept({ERROR}; {VELOCITY})"])
    delay = _delay_ms(case, study)
    assert slope == pytest.approx(delay, abs=1e-6 if case in FIXED else 1e-4)
    assert place == pytest.approx(-study.pretravel_um)
    if case in FIXED:
        turned = study.increment_um / 2 * sum(map(abs, study.away))
        turned /= sum(away**2 for away in study.away)
        expected = delay / 100 + turned, study.increment_um
        assert (slope_width, place_width) == pytest.approx(expected, abs=5e-5)
    else:
        bounds = study.line_bounds(_spread_ms(case, study))
        assert slope_width == pytest.approx(3 * bounds[0], rel=1e-3)
        assert place_width == pytest.approx(3 * bounds[1], rel=1e-3)


@pytest.mark.parametrize("case", AT_SIGNAL)
def test_the_spread_at_the_plc(case: str) -> None:
    """v T_plc from end to end, v (T_plc + T_cnc) with a phase that slides, and an increment."""
    study = Study(case)
    n = study.touches
    bound = math.sqrt((n - 1) / float(chi2.ppf(0.025, n - 1))) - 1.0
    whole_ms = study.plc_ms + (study.cnc_ms if case == "plc-sliding" else 0.0)
    spreads = _numbers(study.checks[f"spread({ERROR}; each)"])
    ranges = _numbers(study.checks[f"range({ERROR}; each)"])
    for speed, spread, (_, width) in zip(study.speeds, spreads, ranges, strict=True):
        expected = speed * _spread_ms(case, study)
        assert spread == (pytest.approx(expected, abs=1e-3),
                          pytest.approx(3 * bound * expected, abs=2e-3))  # fmt: skip
        assert width == pytest.approx(speed * whole_ms + study.increment_um, abs=1e-4)


@pytest.mark.parametrize("case", FIXED)
def test_a_value_that_drive_or_stamp_fixes_does_not_spread(case: str) -> None:
    """An increment about the mean, two from end to end."""
    study = Study(case)
    ((_, spread),) = _numbers(study.checks[f"spread({ERROR}; each)"])
    ((_, width),) = _numbers(study.checks[f"range({ERROR}; each)"])
    assert (spread, width) == pytest.approx((study.increment_um, 2 * study.increment_um), abs=5e-5)


@pytest.mark.parametrize("case", ["drive", "stamp"])
def test_at_1_m_min_drive_and_stamp_are_below_a_tenth_of_a_micrometre(case: str) -> None:
    """The pre-travel apart, and an increment more; the input takes 5 us at most."""
    study = Study(case)
    assert _delay_ms(case, study) <= 0.005
    place = [round(speed * 60) for speed in study.speeds].index(1000)
    middle, width = _numbers(study.checks[f"mean({ERROR}; each)"])[place]
    assert abs(middle + study.pretravel_um) + width <= 0.1 + study.increment_um


@pytest.mark.parametrize("case", [c for c in ROWS if "mean(source_error_um)" in Study(c).checks])
def test_no_touch_is_off_its_closed_form(case: str) -> None:
    study = Study(case)
    mean, = _numbers(study.checks["mean(source_error_um)"])  # fmt: skip
    (_, width), = _numbers(study.checks["range(source_error_um)"])  # fmt: skip
    assert mean == (0.0, pytest.approx(study.increment_um, abs=5e-5))
    assert width == pytest.approx(2 * study.increment_um, abs=5e-5)


def test_such_rows_are_all_but_those_without_a_time_at_the_plc() -> None:
    without = {case for case in ROWS if "mean(source_error_um)" not in Study(case).checks}
    assert without == {"drive", "ext-probe", "ext-position"}
    assert len(list(chain(FIXED, AT_SIGNAL))) == len(ROWS) == 8
