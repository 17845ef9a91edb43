"""A probe that does not repeat, on the machine: each measured value is what its seed draws."""

import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
INCREMENT_MM = 10.0 / 2**20
MODULUS = 2**31 - 1


def drawn_um(seed: int, count: int) -> list[float]:
    """Pre-travel of each touch: 20 um, 4 um of scatter, 9 um more at first, 0.5 um of drift.

    Box and Muller of two congruential sequences, in whole numbers (documentation of the model).
    """
    radius = 1 + 1226874159 * seed % (MODULUS - 1)
    angle = 1 + 62089911 * seed % (MODULUS - 1)
    found = []
    for number in range(count):
        radius, angle = 48271 * radius % MODULUS, 69621 * angle % MODULUS
        normal = math.sqrt(-2 * math.log(radius / MODULUS)) * math.cos(math.tau * angle / MODULUS)
        found.append(20 + 4 * normal + 0.5 * number + (9 if number == 0 else 0))
    return found


@pytest.mark.parametrize("seed", [3, 999_999])
@pytest.mark.long
def test_each_touch_measures_the_pretravel_that_its_seed_draws(
    run_nc: Callable[..., Any], seed: int
) -> None:
    """5 mm/s, an input delay of 4 us: 20 nm more; half an increment by rounding, and the edge."""
    touch = 'N20 G1 G90 Z100.3 F3000\nN30 G100 Z99.5 F300\nN40 #MSG SYN["z=%.6f", V.A.MESS.Z]\n'
    out = run_nc(
        f"N10 $FOR P1 = 1, 6, 1\n{touch}N50 $ENDFOR",
        "",
        "plant:z.position_start_mm=100.3",
        "plant:z.kv=200",
        "plant:probe.pretravel_um=20",
        "plant:probe.pretravel_scatter_um=4",
        "plant:probe.first_touch_um=9",
        "plant:probe.drift_um=0.5",
        f"plant:probe.seed={seed}",
        base="probe-z-workpiece.toml",
    )
    expected = [100 - um / 1e3 - 20e-6 for um in drawn_um(seed, 6)]
    assert out.printed("z") == pytest.approx(expected, abs=INCREMENT_MM)


@pytest.mark.long
def test_the_first_example_of_the_readme_is_what_its_program_shows(
    run_own: Callable[..., Any],
) -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.search(r"\$ \.venv/bin/axisrig nc (\S+) --rig (\S+)\n((?:touch .*\n)+)```", text)
    assert found is not None
    out = run_own(ROOT / found[1], ROOT / found[2], [])
    assert out.lines == found[3].splitlines()
