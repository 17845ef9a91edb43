"""Every limit of testplans/fixed_stop_gantry.csv, recomputed from closed forms written out here.

The rows with a stiff beam are in test_fixed_stop_beam.py. Nothing of the bench is imported: rig,
lists and plan are read as the text files they are. Lengths in mm, times in s, forces in N.
Physics 2(d) of a run to a fixed stop: the lag is v/Kv before the contact and v/Kv + v t - F/k
behind it, so that it is beyond L from (L - v/Kv + F/k)/v on.
"""

import csv
import math
import re
import tomllib
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
RIG = PLANS / "rigs" / "fixed-stop-gantry.toml"
SYNC_S = 48e-6  # test_shipped_bands.py recomputes it
MASS_KG, ROTOR_KG_M2, STIFFNESS_N_UM = 120, 1.8e-4, 20  # AxisRig.Drives.ServoAxis
SLAVES = "set:X.kenngr.measure.fixed_stop_detect.use_gantry_slave"
START = "plant:x.position_start_mm"
SLAVE_LIMIT = "set:X2.kenngr.measure.fixed_stop_detect.pos_lag_limit"

with (PLANS / "fixed_stop_gantry.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file) if "beam" not in row["tags"]}

DATA = tomllib.loads(RIG.read_text(encoding="utf-8"))
LIST = (RIG.parent / DATA["axis"]["X"]["list"]).read_text(encoding="utf-8")
T = DATA["cycle"]["period_us"] * 1e-6
OFFSET = DATA["cycle"]["cycle_offset_us"] * 1e-6
SERVO = DATA["drive"]["servo"]
KV = DATA["plant"]["x"]["start"]["kv"]
DAMPING_S_M = DATA["plant"]["x"]["start"]["stop_damping"]


def _listed(name: str) -> float:
    """The value that every axis of the list has."""
    found = set(re.findall(rf"^{re.escape(name)}\s+(\d+)", LIST, re.M))
    assert len(found) == 1, name
    return float(found.pop())


DETECT = "kenngr.measure.fixed_stop_detect."
LAG_MM, TAU_S = _listed(DETECT + "pos_lag_limit") * 1e-4, _listed(DETECT + "min_time") * 1e-6


def _band(cell: str) -> tuple[float, float]:
    """The bounds of a condition `a .. b` or `a +- b`."""
    if "+-" in cell:
        centre, half = map(float, cell.split("+-"))
        return centre - half, centre + half
    low, high = map(float, cell.split(".."))
    return low, high


class Case:
    """What a row says about its run."""

    def __init__(self, name: str) -> None:
        self.row = ROWS[name]
        is_half = name == "independent"
        self.v = float(self.row["plc:V.E.FEED"]) / 60
        self.slow = self.v / 2 if is_half else self.v
        rated_n = 2 * math.pi * SERVO["rated_torque_mnm"] / SERVO["lead_mm"]
        self.force_n = float(self.row["plc:V.E.LIMIT"]) / 1000 * rated_n
        self.k_n_mm = float(self.row["plant:x.stop_stiffness_n_um"] or STIFFNESS_N_UM) * 1e3
        self.pressed_mm = self.force_n / self.k_n_mm
        self.is_free = self.row["plant:x.stop_position_mm"] == "1000"
        self.finds_slave = self.row[SLAVES] == "1" and (self.is_free or self.row[SLAVE_LIMIT] != "")
        own = self.row[SLAVE_LIMIT]
        self.lag_mm = float(own) * 1e-4 if self.finds_slave and own else LAG_MM

    def detection_s(self) -> tuple[float, float]:
        """From the contact to the NC cycle that finds the stop.

        The actual position is that of the SYNC, judged `OFFSET - SYNC_S` later; the ringing of the
        contact, which decays by 2 m / (alpha F), moves the crossing by no more than itself.
        """
        beyond_s = (self.lag_mm - self.v / KV + self.pressed_mm) / self.v
        mass_kg = MASS_KG + ROTOR_KG_M2 * (2 * math.pi / (SERVO["lead_mm"] * 1e-3)) ** 2
        decay_s = 2 * mass_kg / (DAMPING_S_M * self.force_n)
        loose_s = math.sqrt(mass_kg / (self.k_n_mm * 1e3)) * math.exp(-beyond_s / decay_s)
        first_s = beyond_s + TAU_S + OFFSET - SYNC_S
        return first_s - loose_s, first_s + T + loose_s


def _with(column: str) -> list[str]:
    return [name for name, row in ROWS.items() if row[column] and row["plc:V.E.FEED"]]


@pytest.mark.parametrize("name", _with("check:contact_to_detection_ms"))
def test_the_detection(name: str) -> None:
    low, high = _band(ROWS[name]["check:contact_to_detection_ms"])
    first_s, last_s = Case(name).detection_s()
    assert 0 <= first_s * 1e3 - low <= 0.1
    assert 0 <= high - last_s * 1e3 <= 0.1


@pytest.mark.parametrize("name", _with("check:msg:N126"))
def test_the_measured_value_is_the_place_of_the_master(name: str) -> None:
    """At its stop x + F/k to a micrometre; free, where it is when the slave has found its own."""
    case, (low, high) = Case(name), _band(ROWS[name]["check:msg:N126"])
    stop_mm = DATA["plant"]["x"]["start"]["stop_position_mm"]
    if not case.is_free:
        assert (low + high) / 2 == pytest.approx(stop_mm + case.pressed_mm, abs=5e-5)
        assert high - low == pytest.approx(0.002)
        return
    # free, it is beside its slave at the contact and goes on with v up to the SYNC of the cycle
    reached_mm = [stop_mm + case.v * (at_s - OFFSET + SYNC_S) for at_s in case.detection_s()]
    assert 0 <= reached_mm[0] - low <= 0.001
    assert 0 <= high - reached_mm[1] <= 0.001


def test_the_second_axis_beside_the_path() -> None:
    case, (low, high) = Case("independent"), _band(ROWS["independent"]["check:msg:N128"])
    place_mm = float(ROWS["independent"]["plant:y.stop_position_mm"]) + case.pressed_mm
    assert (low + high) / 2 == pytest.approx(place_mm, abs=5e-5)


FORCES = ("check:stop_force_n:X", "check:stop_force_n:X2", "check:stop_force_end_n:X2")


@pytest.mark.parametrize("column", FORCES)
def test_the_stops_take_the_limit_of_the_torque(column: str) -> None:
    for name in (name for name, row in ROWS.items() if row[column]):
        printed = name == "printed"  # VAL=100 stands in the program
        force_n = Case("in-line" if printed else name).force_n
        low, high = _band(ROWS[name][column])
        assert (low + high) / 2 == pytest.approx(force_n, abs=0.5)
        assert high - low <= 0.008 * force_n


def test_running_lags_stay_below_the_limits_that_are_to_find_a_stop() -> None:
    """Physics 2(d)3: else the lag would find a stop in free space."""
    for name in _with("check:contact_to_detection_ms"):
        case = Case(name)
        assert case.v / KV < case.lag_mm


def test_what_the_cnc_monitors_lies_between_the_motion_and_the_run() -> None:
    """N130 runs at 1000 mm/min: less lag than is monitored; the run itself has more."""
    for name in ("lag-monitored", "lag-monitored-again"):
        allowed_mm = float(ROWS[name]["drive:servo.lag_limit_mm"])
        assert 1000 / 60 / KV < allowed_mm < LAG_MM
        assert ROWS[name]["plc:V.E.FROM"] == ROWS[name][START]  # no rapid traverse


def test_the_slave_may_be_held_back_within_the_first_limit() -> None:
    """15 mm of #SET AX LINK against the stops of both sides, seen from where they are coupled."""
    row = ROWS["slave-14-mm-first"]
    start = float(row["plc:V.E.FROM"])
    master_mm = DATA["plant"]["x"]["start"]["stop_position_mm"] - start
    slave_mm = float(row["plant:x2.stop_position_mm"]) - (start - 100)
    assert slave_mm > 0
    assert master_mm - slave_mm == pytest.approx(14)
    window_mm = float(ROWS["slave-window-left-on"]["plc:V.E.WINDOW"]) * 1e-4
    assert 10 / KV < window_mm < LAG_MM  # the drive finds the lag before the CNC does
