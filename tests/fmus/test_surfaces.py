"""What every surface promises to a sensor, for rises and falls of any kind."""

import random

import numpy as np
import pytest

from axisrig.fmus.build import build

WAVES = 4
# Name, largest magnitude, and whether it may be negative.
LENGTHS = {
    "inclined.angle": (0.6, True),
    "ramp.rise": (3e-3, True),
    "ramp.start": (0.03, True),
    "ramp.length": (0.05, False),
    "step.rise": (3e-3, True),
    "step.start": (0.03, True),
    "sine.amplitude": (1e-3, True),
    "sine.wavelength": (0.05, False),
    "cylinder.axis": (0.03, True),
    "cylinder.radius": (0.05, False),
    "cylinder.round": (0.9, False),
}
PROFILES = ("inclined", "ramp", "step", "sine", "waviness", "cylinder")


def drawn(numbers: random.Random, largest: float, signed: bool) -> float:
    """A number that is not near zero."""
    value = numbers.uniform(0.2 * largest, largest)
    return numbers.choice((-value, value)) if signed else value


def any_workpiece(seed: int) -> dict[str, float | list[float]]:
    """All surfaces at once; flanks do not overlap."""
    numbers = random.Random(seed)
    values: dict[str, float | list[float]] = {
        name: drawn(numbers, *limits) for name, limits in LENGTHS.items()
    }
    values |= {f"{part}.azimuth": numbers.uniform(-3, 3) for part in PROFILES}
    values["step.flank"] = drawn(numbers, 0.02, signed=False)
    values["step.width"] = 1.5 * values["step.flank"]
    values["waviness.amplitude"] = [drawn(numbers, 1e-3, signed=True) for _ in range(WAVES)]
    values["waviness.wavelength"] = [drawn(numbers, 0.1, signed=False) for _ in range(WAVES)]
    return {f"workpiece.{name}": value for name, value in values.items()}


@pytest.fixture(scope="module")
def workpiece(load, cache):
    """All surfaces along the path of their validation, 0.1 m by -0.03 m in 1 s."""
    return load(build("AxisRig.Validation.Workpiece", cache / "surfaces.fmu"))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(20))
def test_no_slope_is_steeper_than_the_steepest(workpiece, seed):
    """Neither the derivatives nor the heights from point to point; 500 points each 0.2 mm."""
    workpiece.restart(**any_workpiece(seed))
    heights, slopes = [], []
    for instant in np.linspace(0, 1, 501):
        if instant:
            workpiece.step_to(instant)
        heights.append(workpiece.height)
        slopes.append(np.hypot(workpiece.slope_x, workpiece.slope_y))
    steepest = workpiece.steepest
    assert max(slopes) <= steepest * (1 + 1e-12)
    rises = np.abs(np.diff(heights)) / (np.hypot(0.1, 0.03) / 500)
    assert rises.max() <= steepest * (1 + 1e-9)
