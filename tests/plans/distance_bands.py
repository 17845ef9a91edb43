"""What the checks of a row of distance control must have, from `distance_law` and the walk.

A value and the width that the plan gives it; a text where a check has no width.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np
from tests.plans.distance_law import Setup
from tests.plans.distance_walk import GAP, alarm, settled, walk

STEP_MS = 60.5  # between two SYNCs
EXPECTED_DEAD = "check:distance_dead_cycles_expected"
DEAD, LIMIT = "check:distance_dead_cycles", "check:distance_kp_limit"
TIME_DEAD, STABILITY = "check:distance_dead_time_ms", "check:distance_stability"
GROWTH, EXPECTED = "check:distance_growth", "check:distance_growth_expected"
ERROR, BEHIND = "check:distance_error_um", "check:distance_behind_um"
SINE, NOISE = "check:distance_sine_gain", "check:offset_noise_um"
SETTLING, OVERSHOOT = "check:distance_settling_ms", "check:distance_overshoot_mm"
AFTER = "check:distance_alarm_after_cycles"
Band = tuple[float, float]


def dead_of(setup: Setup) -> int:
    """Dead cycles: by scheduling and carrier, and one for each cycle that the sensor is older.

    A value that comes with every second SYNC shows the answer at the first even cycle.
    """
    dead = setup.n + setup.age
    if "every-second" in setup.row["rig"]:
        dead = math.ceil((dead + 1) / 2) * 2 - 1
    return dead


def lifted(setup: Setup) -> np.ndarray:
    """The surface of a row with a step, at each SYNC."""
    count = round(setup.number("plc:V.E.TIME") / setup.T)
    after = np.arange(count) >= round(STEP_MS)
    return np.where(after, setup.number("plant:gap.lift_mm"), 0.0)


def stability_bands(setup: Setup) -> dict[str, Band]:
    """Limit of kp, largest pole by the arithmetic, and as the steps show it."""
    growth = setup.growth(setup.kp)
    return {
        LIMIT: (setup.limit, 0.0002),
        EXPECTED: (growth, 0.00005),
        GROWTH: (growth, abs(growth - 1) * 0.2 + 0.0008),
    }


def ramp_bands(setup: Setup) -> dict[str, Band]:
    """v T/kp before the update in every mode, within 1 %; one row takes another kp over."""
    kp = 0.4 if setup.row["case"] == "plc-object-kp" else setup.kp
    error, behind = setup.rise * setup.T / kp * 1e3, setup.behind * 1e3
    return {ERROR: (error, abs(error) * 0.01), BEHIND: (behind, abs(behind) * 0.01)}


def sine_band(setup: Setup) -> Band:
    """Error of the distance over the surface, 1 %, 2 % of a wave on the workpiece."""
    f, share, least = setup.number("plant:gap.sway_frequency_hz"), 0.01, 0.0005
    if not f:
        wave = setup.number("plant:gap.workpiece.sine.wavelength_mm")
        f, share, least = setup.number("plc:V.E.FEED") / 60 / wave, 0.02, 0.0
    gain = setup.sine_gain(f)
    return gain, max(gain * share, least)


def noise_band(setup: Setup) -> Band:
    """White noise that grows with the square of the distance; 15 % for 750 values of it."""
    start, gain = setup.polynomials
    below = np.polynomial.polynomial.polyadd(start, setup.kp * gain)
    above = setup.kp * np.convolve(setup.control, setup.filter[0])
    answer = np.zeros(5000)
    for k in range(len(answer)):
        past = sum(below[i] * answer[k - i] for i in range(1, min(len(below), k + 1)))
        answer[k] = ((above[k] if k < len(above) else 0.0) - past) / below[0]
    sigma = setup.number("plant:gap.noise_um") * GAP**2 * math.sqrt(float(answer @ answer))
    return sigma, sigma * 0.15


# The same with other dead cycles


def restated(setup: Setup) -> dict[str, str]:
    """Return the inputs and checks of a row that its dead cycles change.

    kp of a row next to its limit stays at the same share of it; else the inputs are those of the
    row. An alarm that a wrong sign or the defaults bring, and what moves by the program of the PLC,
    is walked.
    """
    found: dict[str, str] = {}
    on_can = Setup(setup.row)
    if setup.row["case"].endswith(("-below", "-above")):
        kp = setup.kp * setup.limit / on_can.limit
        found["set:Z.kenngr.distc.kp"] = f"{kp:.6f}"
        setup = Setup(setup.row | found, setup.late)
    for column, words in _restated(setup):
        if setup.row.get(column):
            found[column] = words
    return found


def _restated(setup: Setup) -> Iterator[tuple[str, str]]:
    row, dead = setup.row, dead_of(setup)
    yield DEAD, f"== {dead}"
    yield EXPECTED_DEAD, f"== {dead}"
    # From the frame of the sensor value to that which shows its answer: what it is older, and
    # what a carrier adds, is in it
    yield TIME_DEAD, f"{(dead + 1) * setup.T * 1e3:g} +- 0.05"
    if row.get(LIMIT):
        yield from _texts(stability_bands(setup))
        yield STABILITY, "== stable" if setup.growth(setup.kp) < 1 else "== unstable"
        if row["check:alarms"] == "none":
            at_rest = np.zeros(round(setup.number("plc:V.E.TIME") / setup.T))
            due = alarm(setup, walk(setup, at_rest))
            yield "check:alarms", "none" if due is None else f"== {due[0]}"
    if row.get(ERROR):
        yield from _texts(ramp_bands(setup))
    for column, band in ((SINE, sine_band), (NOISE, noise_band)):
        if row.get(column):
            yield from _texts({column: band(setup)})
    if row.get(SETTLING) or row.get(OVERSHOOT):
        yield from _step(setup)
    if row.get(AFTER):
        due = alarm(setup, walk(setup, np.zeros(4000)))
        assert due is not None
        yield AFTER, f"== {due[1]}"
    if row["case"] in BY_PLC:
        yield from BY_PLC[row["case"]](setup)


def _texts(bands: dict[str, Band]) -> Iterator[tuple[str, str]]:
    for column, (middle, width) in bands.items():
        yield column, f"{middle - width:.6f} .. {middle + width:.6f}"


def _step(setup: Setup) -> Iterator[tuple[str, str]]:
    """Settling to the cycle; overshoot to an increment of the sensor, 10 % with a real drive."""
    time, beyond = settled(walk(setup, lifted(setup)), GAP)
    yield SETTLING, f"== {time * setup.T * 1e3:g}"
    width = beyond * 0.1 if setup.drive_lag else 0.00005
    yield OVERSHOOT, "<= 0.0001" if beyond < 1e-4 else f"{beyond:.6f} +- {width:.6f}"


def _ramp_of_the_plc(setup: Setup) -> Iterator[tuple[str, str]]:
    """SET_DIST from 2 to 3 mm between 100 and 300 ms."""
    at_ms = np.arange(450)
    positions = 2 + np.clip((at_ms - 100) / 200, 0.0, 1.0)
    walked = walk(setup, np.zeros(len(at_ms)), positions)
    yield "check:offset_mm_max", f"{walked.offset.max():.6f} +- 0.0001"
    behind = np.abs(positions - walked.gap).max() * 1e3
    yield "check:distance_behind_um_max", f"{behind:.4f} +- 0.05"


def _steps_of_the_plc(setup: Setup) -> Iterator[tuple[str, str]]:
    """SET_DIST 2, 2.2 and 2.1 mm."""
    at_ms = np.arange(450)
    positions = np.select([at_ms < 100, at_ms < 250], [2.0, 2.2], 2.1)
    walked = walk(setup, np.zeros(len(at_ms)), positions)
    yield "check:offset_mm_max", f"{walked.offset.max():.6f} +- 0.00001"


def _held_and_let_go(setup: Setup) -> Iterator[tuple[str, str]]:
    """A part of the 0.5 mm is followed before the hold: the step of the rest goes less too far."""
    walked = walk(setup, np.where(np.arange(300) >= 10, 0.5, 0.0))
    yield "check:offset_mm_max", f"0.4999 .. {walked.offset.max() + 0.0001:.6f}"


BY_PLC: dict[str, Callable[[Setup], Iterator[tuple[str, str]]]] = {
    "plc-set-dist-ramp": _ramp_of_the_plc,
    "plc-set-dist-steps": _steps_of_the_plc,
    "plc-axis-override": _held_and_let_go,
}
