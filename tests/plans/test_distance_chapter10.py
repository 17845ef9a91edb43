"""Limits of testplans/distance_chapter10.csv follow from rig, list and closed forms.

Nothing of the bench or of the kernel is imported. Lengths in mm, times in s.
"""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

PLANS = Path(__file__).parents[2] / "testplans"
ROWS = list(csv.DictReader((PLANS / "distance_chapter10.csv").open(encoding="utf-8")))
SET_POS, CYCLE = 40.0, 1e-3
V, A, KP, N = 50.0, 10_000.0, 0.2, 20  # lists/axis-z-distance-example.lst
A_MIN, E_MIN, E_MAX = 1000.0, 0.025, 0.05
SIGMA, PROCESS = 0.1, 0.1  # of KALMAN_MA: kalman_sigma 1000, walk of the distance in a cycle
ENCODER, SENSOR_AT_1_MM, GAP = 0.5e-3, 0.25e-3, 2.0
INCREMENTS = 2 * 1e-5  # of encoder and sensor
DEVIATIONS = 5.0
_OFF, _ON_AGAIN = 5, 4


def band(cell: str) -> tuple[float, float]:
    """Middle and half width of a condition."""
    if "+-" in cell:
        middle, half = cell.split("+-")
        return float(middle), float(half)
    return float(cell), 0.0


def kalman_weights() -> np.ndarray:
    """KALMAN_MA as one sum over the last values: y = p + K (s - p), p = M + (1 + 1/L)(M - MM).

    L = (N - 1)/2, K = (g r + q)/(g r + q + r); docs/ambiguities.md, "Distance control".
    """
    mean = np.full(N, 1.0 / N)
    twice = np.convolve(mean, mean)
    of_prediction = -(1.0 + 2.0 / (N - 1)) * twice
    of_prediction[:N] += (2.0 + 2.0 / (N - 1)) * mean
    variance = float(np.sum(of_prediction**2)) * SIGMA**2 + PROCESS**2
    gain = variance / (variance + SIGMA**2)
    weights: np.ndarray = np.concatenate([[gain], (1.0 - gain) * of_prediction])
    return weights


def test_the_filter_leaves_a_constant() -> None:
    assert float(np.sum(kalman_weights())) == pytest.approx(1.0)


def noise_of_offset() -> float:
    """Standard deviation of the offset: o += kp (filter(noise) - o), noise of encoder and sensor.

    The sensor's grows with the square of the distance.
    """
    white = math.hypot(ENCODER, SENSOR_AT_1_MM * GAP**2)
    loop = KP * (1.0 - KP) ** np.arange(200)
    return white * float(np.sqrt(np.sum(np.convolve(kalman_weights(), loop) ** 2)))


def noise_of_zero() -> float:
    """Standard deviation of the zero that REF sets: of the sensor alone, as the filter gives it."""
    return SENSOR_AT_1_MM * GAP**2 * float(np.sqrt(np.sum(kalman_weights() ** 2)))


def offset(row: dict[str, str], part: int) -> float:
    """What the surface has moved by when the part ends; FREEZE keeps what was before."""
    first, second = float(row["plant:gap.lift_mm"]), float(row["plant:gap.lift_2_mm"])
    return [0.0, 0.0, first, first, first + second, first + second][part]


def is_noisy(row: dict[str, str]) -> bool:
    return row["plant:z.noise_mm"] != "0"


def part_of(row: dict[str, str]) -> int:
    return int(row["plc:V.E.PART"] or row["note:part"] or _OFF)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["case"])
def test_offset_is_the_way_of_the_surface(row: dict[str, str]) -> None:
    """With noise the zero of the sensor is what the filter gave: REF."""
    middle, half = band(row["check:offset_end_mm"])
    part = part_of(row)
    if part == _OFF:
        assert (middle, half) == (0.0, 0.0)
        return
    assert middle == offset(row, part)
    needed = DEVIATIONS * math.hypot(noise_of_offset(), noise_of_zero())
    assert half == 1e-5 if not is_noisy(row) else needed <= half <= 1.2 * needed


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["case"])
def test_the_tool_keeps_its_place_above_the_true_surface(row: dict[str, str]) -> None:
    if not row["check:distance_behind_end_um"]:
        return
    middle, half = band(row["check:distance_behind_end_um"])
    assert middle == 0.0
    if not is_noisy(row):
        assert half <= 2.5 * INCREMENTS * 1e3
        return
    needed = DEVIATIONS * noise_of_offset() * 1e3
    assert needed <= half <= 1.6 * needed


@pytest.mark.parametrize("row", [r for r in ROWS if r["check:distance_settling_ms"]])
def test_settling_lies_between_the_fastest_step_and_the_same_with_the_law(
    row: dict[str, str],
) -> None:
    """H/v + v/a; behind it the P law runs into the band with 1/K, and past it once by at most
    v^2/2a_min, which a_min then takes back.
    """
    low, high = (float(part) * 1e-3 for part in row["check:distance_settling_ms"].split(".."))
    fastest = float(row["plant:gap.lift_mm"]) / V + V / A
    gain = KP / CYCLE
    assert low == pytest.approx(fastest)
    past = math.log(E_MAX / 0.015) / gain + 2.0 * (E_MAX * gain) / A_MIN
    assert fastest + past <= high <= fastest + past + 10 * CYCLE


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["case"])
def test_limits_are_those_of_the_list(row: dict[str, str]) -> None:
    """To the rounding of a double that is differenced: 1e-16/T and 1e-16/T^2 are far below."""
    assert row["check:offset_speed_mm_s_max"] == f"<= {V + 1e-6:.6f}"
    assert row["check:offset_acceleration_mm_s2_max"] == f"<= {A + 1e-3:.3f}"


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["case"])
def test_the_program_sees_where_the_axis_is(row: dict[str, str]) -> None:
    part = part_of(row)
    found = {
        "check:msg:N170": offset(row, min(part, _ON_AGAIN)),
        "check:msg:N210": 0.0,
        "check:msg:N50": 0.0 if part == _OFF else offset(row, part),
    }
    for column, place in found.items():
        if not row[column]:
            continue
        middle, half = band(row[column])
        assert middle == SET_POS + place
        if is_noisy(row):
            spread = math.hypot(ENCODER, noise_of_offset(), noise_of_zero())
            needed = DEVIATIONS * (spread if place or part != _OFF else ENCODER)
            assert needed <= half <= 1.6 * needed
        else:
            assert half == INCREMENTS


def test_dead_cycles_are_one_and_without_optimized_scheduling_two() -> None:
    """docs/distance-control.md, "Dead time and stability"."""
    answer = {
        row["set:Z.kenngr.distc.optimized_scheduling"] or "1": row["check:distance_dead_cycles"]
        for row in ROWS
        if row["check:distance_dead_cycles"]
    }
    assert answer == {"1": "1", "0": "2"}


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["case"])
def test_a_control_that_is_on_at_the_end_is_told(row: dict[str, str]) -> None:
    assert row["check:alarms"] == ("none" if part_of(row) == _OFF else "70332")
    assert bool(row["check:freeze_drift_um"]) == (part_of(row) >= 3)


COMMANDS = ("ON", "FREEZE", "ON", "OFF")
STATES = ("ACTIVE", "ACTIVE", "FREEZE", "ACTIVE", "INACTIVE")


@pytest.mark.parametrize("row", [row for row in ROWS if row["plc:Z.dist_ctrl"]])
def test_the_plc_commands_what_a_part_needs(row: dict[str, str]) -> None:
    """Numbers of FCT-M3 10: set position 40 mm, 1 = ON, 2 = FREEZE, 0 = OFF."""
    cells = [cell.split() for cell in row["plc:Z.dist_ctrl"].split(";")]
    part = part_of(row)
    assert tuple(cell[0] for cell in cells) == COMMANDS[: max(part - 1, 1)]
    assert cells[0][1] == f"set_pos={SET_POS:g}"
    assert row["check:distance_state_end"] == STATES[part - 1]


@pytest.mark.parametrize(
    "row", [r for r in ROWS if "task" in r["tags"].split()], ids=lambda r: r["case"]
)
def test_the_unit_shows_surface_offset_state_and_source(row: dict[str, str]) -> None:
    """Lengths in 0.1 um; the second change of the surface comes after the command FREEZE."""
    part = int(row["plc:V.E.PART"])
    surface = SET_POS + float(row["plant:gap.lift_mm"])
    surface += float(row["plant:gap.lift_2_mm"]) if part > 2 else 0.0
    state = {2: 1, 3: 2, 4: 1, 5: 0}[part]
    shown = [band(row[f"check:msg:N60.{k}"].removeprefix("==")) for k in range(1, 5)]
    left = 0.0 if part == _OFF else offset(row, part)
    assert [middle for middle, _ in shown] == [surface * 1e4, left * 1e4, state, 1]
    assert all(half <= 1.0 for _, half in shown)
