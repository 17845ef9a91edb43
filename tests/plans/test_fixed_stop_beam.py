"""The limits of the rows of testplans/fixed_stop_gantry.csv whose sides stand on one stiff beam.

Nothing of the bench is imported. Lengths in mm, times in s, forces in N, stiffnesses in N/mm.
Statics of a beam that turns freely about the vertical, F_i force of each motor, S_i of each stop
at its end of the beam: S_1 + S_2 = F_1 + F_2 and, about the middle, S_1 - S_2 = F_1 - F_2. So each
stop takes the motor of its own side, S_i = F_i, and a side without a stop goes on (F = 0). The
encoder of a side sits on its motor: ahead of the stop by F/k of the stop and F/k_c of the coupling
to the beam. Lag of a side at its stop: v/Kv + v t - F/k - F/k_c.
"""

import csv
import math
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
PLANS = ROOT / "testplans"
RIGS = PLANS / "rigs"
MODEL = (ROOT / "fmus/axisrig/fmus/AxisRig/Drives/GantryPair.mo").read_text(encoding="utf-8")
SYNC_S = 48e-6  # test_shipped_bands.py recomputes it
SLAVES = "set:X.kenngr.measure.fixed_stop_detect.use_gantry_slave"
DETECTION, VALUE = "check:contact_to_detection_ms", "check:msg:N126"
STOPS = {"X": "plant:x.stop_position_1_mm", "X2": "plant:x.stop_position_2_mm"}

with (PLANS / "fixed_stop_gantry.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file) if "beam" in row["tags"]}


def _rig(name: str) -> dict[str, Any]:
    """The tables of a rig over those of its bases."""
    own = tomllib.loads((RIGS / name).read_text(encoding="utf-8"))
    return _over(_rig(own["base"]), own) if "base" in own else own


def _over(below: dict[str, Any], above: dict[str, Any]) -> dict[str, Any]:
    merged = dict(below)
    for key, value in above.items():
        known = merged.get(key)
        merged[key] = _over(known, value) if isinstance(known, dict) else value
    return merged


DATA = _rig("fixed-stop-beam.toml")
LIST = (RIGS / DATA["axis"]["X"]["list"]).read_text(encoding="utf-8")
T, OFFSET = (DATA["cycle"][key] * 1e-6 for key in ("period_us", "cycle_offset_us"))
SERVO, START = DATA["drive"]["servo"], DATA["plant"]["x"]["start"]


def _listed(name: str) -> float:
    """The value that every axis of the list has."""
    found = set(re.findall(rf"^{re.escape(name)}\s+(\d+)", LIST, re.M))
    assert len(found) == 1, name
    return float(found.pop())


def _default(name: str) -> float:
    """The start value of a parameter of the model, SI."""
    found = re.search(rf"\b{name}(?:\([^)]*\))? = ([-\d.e]+)", MODEL)
    assert found is not None, name
    return float(found[1])


DETECT = "kenngr.measure.fixed_stop_detect."
LAG_MM, TAU_S = _listed(DETECT + "pos_lag_limit") * 1e-4, _listed(DETECT + "min_time") * 1e-6
STOP_N_MM, COUPLING_N_MM = (
    _default(name) * 1e-3 for name in ("stop_stiffness", "coupling_stiffness")
)


def _force_n(row: dict[str, str]) -> float:
    rated_n = 2 * math.pi * SERVO["rated_torque_mnm"] / SERVO["lead_mm"]
    return float(row["plc:V.E.LIMIT"]) / 1000 * rated_n


def _ahead_mm(row: dict[str, str]) -> float:
    return _force_n(row) * (1 / STOP_N_MM + 1 / COUPLING_N_MM)


def _speed_mm_s(row: dict[str, str]) -> float:
    return float(row["plc:V.E.FEED"]) / 60


def _place_mm(row: dict[str, str], axis: str) -> float:
    own = row[STOPS[axis]]
    return float(own or START[STOPS[axis].removeprefix("plant:x.")])


def _beyond_s(row: dict[str, str]) -> float:
    """From the contact to the lag above its limit."""
    v = _speed_mm_s(row)
    return (LAG_MM - v / START["kv"] + _ahead_mm(row)) / v


def _rotor_kg() -> float:
    return START["rotor_inertia"] * (2 * math.pi / (START["screw_lead_mm"] * 1e-3)) ** 2


def _ringing_s(row: dict[str, str]) -> float:
    """How far the ringing of the contact moves the crossing at most.

    It is v sqrt(m/k) deep and decays by 2 m/(alpha F). m of an end: its carriage and rotor with
    half of the beam when both ends are stopped at once, m/4 + I/L^2 when the other one goes on.
    """
    rotor_kg = _rotor_kg()
    beam_kg = _default("beam_mass") / 2
    if _place_mm(row, "X") != _place_mm(row, "X2"):
        beam_kg = beam_kg / 2 + _default("beam_inertia") / _default("span") ** 2
    mass_kg = _default("carriage_mass") + rotor_kg + beam_kg
    decay_s = 2 * mass_kg / (START["stop_damping"] * _force_n(row))
    return math.sqrt(mass_kg / (STOP_N_MM * 1e3)) * math.exp(-_beyond_s(row) / decay_s)


def _band(cell: str) -> tuple[float, float]:
    if "+-" in cell:
        centre, half = map(float, cell.split("+-"))
        return centre - half, centre + half
    low, high = map(float, cell.split(".."))
    return low, high


FOUND = [name for name, row in ROWS.items() if row[DETECTION]]


def test_the_rows_have_stops_at_either_side_and_at_both() -> None:
    near = {tuple(_place_mm(row, axis) < 100 for axis in STOPS) for row in ROWS.values()}
    assert near == {(True, True), (True, False), (False, True)}
    assert all(DATA["plant"][plant]["fmu"].endswith("GantryPair") for plant in ("x", "x2"))


@pytest.mark.parametrize("name", FOUND)
def test_the_detection(name: str) -> None:
    row = ROWS[name]
    low, high = _band(row[DETECTION])
    first_s, loose_s = _beyond_s(row) + TAU_S + OFFSET - SYNC_S, _ringing_s(row)
    assert 0 <= (first_s - loose_s) * 1e3 - low <= 0.1
    assert 0 <= high - (first_s + T + loose_s) * 1e3 <= 0.1


@pytest.mark.parametrize("name", FOUND)
def test_the_measured_value_is_the_place_of_the_motor_of_the_master(name: str) -> None:
    row, (low, high) = ROWS[name], _band(ROWS[name][VALUE])
    if row[SLAVES] != "1":
        place_mm = _place_mm(row, "X") + _ahead_mm(row)
        assert (low + high) / 2 == pytest.approx(place_mm, abs=5e-5)
        assert high - low == pytest.approx(0.002)
        return
    # free: beside its slave at the contact, on with v up to the SYNC of the cycle of the detection
    v, loose_s = _speed_mm_s(row), _ringing_s(row)
    taken_s = _beyond_s(row) + TAU_S
    reached_mm = [
        _place_mm(row, "X2") + v * at for at in (taken_s - loose_s, taken_s + T + loose_s)
    ]
    assert 0 <= reached_mm[0] - low <= 0.001
    assert 0 <= high - reached_mm[1] <= 0.001


def test_each_stop_takes_the_motor_of_its_own_side() -> None:
    columns = ("check:stop_force_n:X", "check:stop_force_n:X2", "check:stop_force_end_n:X2")
    cells = [(row, row[column]) for row in ROWS.values() for column in columns if row[column]]
    assert cells
    for row, cell in cells:
        low, high = _band(cell)
        assert (low + high) / 2 == pytest.approx(_force_n(row), abs=0.5)
        assert high - low <= 0.008 * _force_n(row)


def test_running_lags_stay_below_the_limit() -> None:
    for row in ROWS.values():
        assert _speed_mm_s(row) / START["kv"] < LAG_MM


def test_the_limit_of_the_torque_drives_the_ramp() -> None:
    """Half of the beam, carriage and rotor with the acceleration of measurement runs."""
    side_kg = _default("carriage_mass") + _rotor_kg() + _default("beam_mass") / 2
    a_m_s2 = _listed("getriebe[0].lslope_profil.a_grenz_stufe_1") * 1e-3
    for row in ROWS.values():
        assert _force_n(row) > 1.5 * side_kg * a_m_s2
