"""Limits of the study of signal sources, recomputed from closed forms written out here.

Down at v: published less true position at the contact is -(p + v D), with the pre-travel p and the
delay D of the chain. So D is the slope over the true velocity and -p the intercept. Nothing of the
bench is imported: rigs and plan are read as the text files they are.

A check passes where its value is inside by more than twice its bound. So a limit of three times the
bound asks that the closed form is within the bound of 95 %.

A fixed stop has no error against the contact, since it yields: its line is that of the value, which
is x_stop + F/k at any v.
"""

import csv
import math

import pytest
from scipy.stats import chi2, t
from tests.plans.shipped_files import PLANS, rig_of

SYNC_MS = 0.048  # 44 bits and 4 stuff bits at 1 Mbit/s
LEAD_UM = 10_000.0
# What the rig of the stop leaves out: fmus/README.md, "ServoAxis"; drive profile `canopen`
RATED_TORQUE_MNM, STIFFNESS_N_UM, MASS_KG, ROTOR_INERTIA = 2200.0, 20.0, 120.0, 1.8e-4


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
STOP = "fixed-stop"
FIXED = ("drive", "drive-default", "stamp", "ext-probe")
AT_SIGNAL = tuple(case for case in ROWS if case not in (*FIXED, STOP))
AT_PROBE = (*FIXED, *AT_SIGNAL)
VELOCITY, ERROR, VALUE = "contact_velocity_mm_s", "latch_error_um", "latch_mm"


class Study:
    """What a row is about: its speeds, its chain and its increment."""

    def __init__(self, case: str) -> None:
        row = ROWS[case]
        self.inputs, self.checks = _inputs(row), _checks(row)
        self.rig = rig_of(PLANS / row["rig"])
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


def _to_plc_ms(study: Study) -> float:
    """From an NC cycle to the cycle of the PLC after it."""
    return float((study.rig["plc"]["offset_us"] / 1e3 - study.turn_ms) % study.cnc_ms)


def _to_cnc_ms(study: Study) -> float:
    """From a cycle of the PLC to the NC cycle after it."""
    return float((study.turn_ms - study.rig["plc"]["offset_us"] / 1e3) % study.cnc_ms)


def _delay_ms(case: str, study: Study) -> float:
    """The mean from contact to the instant whose position is the value."""
    of_drive = float(study.rig["drive"]["servo"].get("input_delay_us", 0)) / 1e3
    if case in AT_SIGNAL:
        return _delay_at_plc_ms(case, study, of_drive)
    radio = float(study.inputs.get("plant:probe.radio_delay_ms", 0))
    return study.input_ms if case == "stamp" else radio + of_drive


def _delay_at_plc_ms(case: str, study: Study, of_drive: float) -> float:
    """Input + T_plc/2 + hand-over less the age of the actual value."""
    to_plc, to_cnc = _to_plc_ms(study), _to_cnc_ms(study)
    after_plc_ms = {
        "plc-sliding": study.cnc_ms / 2 - study.age_ms,
        # SYNC, PLC with its telegram, NC cycle of the same SYNC
        "io-node": 0.0,
        # SYNC, NC cycle, PLC, NC cycle: less the age, from the SYNC of the last one
        "drive-input": to_plc + to_cnc,
        # the PLC sees what the NC cycle before it has taken over
        "ext-position": -to_plc - study.age_ms,
    }.get(case, to_cnc - study.age_ms)
    late = of_drive if case == "drive-input" else study.input_ms
    return late + study.plc_ms / 2 + after_plc_ms


def test_the_node_samples_before_the_plc_reads_it_and_both_before_the_nc_cycle() -> None:
    study = Study("io-node")
    assert SYNC_MS < study.rig["plc"]["offset_us"] / 1e3 < study.turn_ms


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
        *("EXT_PROBE_WITH_DRIVE", "DRIVE_TYPE_DEFAULT", "FIXED_STOP"),
    }
    for case, row in ROWS.items():
        study = Study(case)
        assert len(study.speeds) >= 3, case
        assert study.touches == 50, case
        assert study.checks[f"count({VALUE if case == STOP else ERROR})"] == "== 150", case
        cycle = float(row["plc:V.E.CYCLE_MS"])
        assert cycle == (13.0 if case == "plc-sliding" else study.plc_ms or 1.0), case


@pytest.mark.parametrize("case", ROWS)
def test_every_edge_is_in_constant_feed(case: str) -> None:
    """A tenth of a percent: a tenth of what the slope may be off."""
    study, sign = Study(case), 1 if case == STOP else -1  # towards its stop Z goes up
    means = _numbers(study.checks[f"mean({VELOCITY}; each)"])
    ranges = _numbers(study.checks[f"range({VELOCITY}; each)"])
    for speed, mean, (_, width) in zip(study.speeds, means, ranges, strict=True):
        assert mean == (pytest.approx(sign * speed, abs=1e-4),
                        pytest.approx(speed * 1e-3, abs=1e-4))  # fmt: skip
        assert width == pytest.approx(speed * 1e-3, abs=1e-4)


@pytest.mark.parametrize("case", AT_PROBE)
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


@pytest.mark.parametrize("case", AT_PROBE)
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


def test_such_rows_are_all_but_those_without_a_terminal_of_the_plc() -> None:
    without = {case for case in ROWS if "mean(source_error_um)" not in Study(case).checks}
    assert without == {*FIXED, "drive-input", "ext-position", STOP} - {"stamp"}
    assert len(AT_PROBE) + 1 == len(ROWS) == 12


# The fixed stop


def _pressing_n(study: Study) -> float:
    """Torque limit, in 0.1 % of the rated torque, through the screw; no friction, no weight."""
    servo, plant = study.rig["drive"]["servo"], study.rig["plant"]["z"]
    assert plant["fmu"] == "AxisRig.Drives.ServoAxis"
    assert plant["start"]["coulomb_friction_n"] == plant["start"]["breakaway_friction_n"] == 0
    assert servo.get("rated_torque_mnm", RATED_TORQUE_MNM) == RATED_TORQUE_MNM
    torque_nm = float(study.inputs["plc:V.E.LIMIT"]) / 1000 * RATED_TORQUE_MNM / 1000
    return torque_nm * 2 * math.pi / (float(servo["lead_mm"]) / 1000)


def test_the_value_at_a_stop_is_its_place_and_what_the_force_presses_in() -> None:
    """x_stop + F/k at every feed, within an increment: slope 0, intercept x_stop + F/k."""
    study = Study(STOP)
    start = study.rig["plant"]["z"]["start"]
    place_mm = start["stop_position_mm"] + _pressing_n(study) / STIFFNESS_N_UM / 1000
    step_mm = study.increment_um / 1000
    for name in (f"mean({VALUE}; each)", f"intercept({VALUE}; {VELOCITY})"):
        ((middle, width),) = _numbers(study.checks[name])
        assert middle == pytest.approx(place_mm, abs=1e-7)
        assert width == pytest.approx(step_mm, abs=5e-8)
    ((slope, turned),) = _numbers(study.checks[f"slope({VALUE}; {VELOCITY})"])
    assert slope == 0.0
    most = step_mm / 2 * sum(map(abs, study.away)) / sum(away**2 for away in study.away)
    assert turned == pytest.approx(most, abs=5e-9)
    ((_, spread),) = _numbers(study.checks[f"spread({VALUE}; each)"])
    ((_, whole),) = _numbers(study.checks[f"range({VALUE}; each)"])
    assert (spread, whole) == pytest.approx((step_mm, 2 * step_mm), abs=5e-8)


def test_the_axis_has_stopped_ringing_when_its_stop_is_found() -> None:
    """Swing of impact and of the step of the force, exp(-tau F alpha / 2 m): below half a step."""
    study = Study(STOP)
    start = study.rig["plant"]["z"]["start"]
    force_n, k_n_m = _pressing_n(study), STIFFNESS_N_UM * 1e6
    screw_m = float(study.rig["drive"]["servo"]["lead_mm"]) / 1000 / (2 * math.pi)
    mass_kg = MASS_KG + ROTOR_INERTIA / screw_m**2
    detect = "set:Z.kenngr.measure.fixed_stop_detect."
    tau_s = float(study.inputs[f"{detect}min_time"]) * 1e-6
    impact_m = max(study.speeds) / 1000 * math.sqrt(mass_kg / k_n_m)
    swing_um = math.hypot(impact_m, force_n / k_n_m) * 1e6
    left_um = swing_um * math.exp(-tau_s * force_n * start["stop_damping"] / (2 * mass_kg))
    assert left_um < study.increment_um / 2
