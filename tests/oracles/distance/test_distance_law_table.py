"""Loops of every printed controller setting under every choice of the law: `law_table.csv`.

`law_table.csv` holds spectral radii of an ideal loop, to six digits, from a simulation that shares
nothing with this bench: sensor and motor of one SYNC, dead_cycles beyond the one cycle of every
sampled loop (with both encoders: of Z_com), a filter on the sensor value, and

    o(k+1) = o(k) + kp (e + T/Tn sum(e) + r (y - y before)),  r = Tv/T per second, Tv per cycle

with y the error or the filtered feedback. `law_settings.csv` has the settings as they are printed.
"""

import csv
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from axisrig.bench.oracles.distance.lists import Control
from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS, Loop, growth
from axisrig.bench.oracles.distance.sample_hold import held_growth
from axisrig.bench.oracles.distance.smoothing import of_control
from axisrig.bench.oracles.distance.stability import kp_limit
from axisrig.kernel.time.clock import MS

HERE = Path(__file__).parent
MODES = {"CONST_DIST": CONST_DIST, "both": BOTH, "SET_POS": SET_POS}
TO_FOUR_DIGITS = 5e-5


@dataclass(frozen=True)
class Cell:
    """A loop with its kp, and the largest magnitude of its poles."""

    name: str
    loop: Loop
    kp: float
    growth: float


def rows(name: str) -> list[dict[str, str]]:
    with (HERE / name).open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def listed(row: dict[str, str]) -> Control:
    numbers = {"count": int(row["count"]), "kp": float(row["kp"])}
    for name in ("tn_s", "tv_s", "alpha", "sigma_mm"):
        if row[name]:
            numbers[name] = float(row[name])
    return Control(filter_type=row["filter_type"], **numbers)  # type: ignore[arg-type]


def loop_of(control: Control, mode: str, period_ns: int, cycles: int) -> Loop:
    return Loop(
        MODES[mode],
        cycles + (mode == "both"),
        of_control(control, period_ns),
        sent_cycles=cycles,
        integral=control.integral(period_ns),
        derivative=control.rate(period_ns),
        of_error=control.looks_at_error,
    )


@cache
def cells() -> list[Cell]:
    controls = {row["setting"]: listed(row) for row in rows("law_settings.csv")}
    found = []
    for row in rows("law_table.csv"):
        control = controls[row["setting"]]
        choices = {key: row[key] for key in ("derivative", "derivative_of")}
        control = Control(**{**vars(control), **choices})
        period_ns = round(float(row["period_ms"]) * MS)
        cycles = int(row["dead_cycles"] or 0)
        loop = loop_of(control, row["mode"], period_ns, cycles)
        found.append(Cell(" ".join(row.values()), loop, control.kp, float(row["growth"])))
    return found


@pytest.mark.long
def test_every_cell_of_the_table_grows_as_its_poles_say() -> None:
    """756 cells, to 4 digits; the poles themselves are as exact as the filter is long."""
    off = [
        f"{cell.name}: {growth(cell.loop, cell.kp):.6f}"
        for cell in cells()
        if growth(cell.loop, cell.kp) != pytest.approx(cell.growth, abs=TO_FOUR_DIGITS)
    ]
    assert len(cells()) == 756
    assert off == []


@pytest.mark.long
def test_the_limit_of_kp_lies_where_the_table_says() -> None:
    """Above the kp of each stable cell, at or below that of each other; there the growth is 1."""
    for cell in cells():
        limit = kp_limit(cell.loop)
        assert (cell.kp < limit) == (cell.growth < 1.0), cell.name
        assert growth(cell.loop, limit) == pytest.approx(1.0, abs=TO_FOUR_DIGITS), cell.name


@pytest.mark.long
def test_a_sensor_value_with_every_cycle_is_held_by_nobody() -> None:
    """The product of the matrices of one cycle is the loop itself; every 7th cell."""
    for cell in cells()[::7]:
        assert held_growth(cell.loop, 1, cell.kp) == pytest.approx(cell.growth, abs=1e-4), cell.name


def test_a_derivative_per_cycle_is_that_of_a_cycle_of_a_second() -> None:
    """Tv counts as Tv/T does at T = 1 s, whatever the cycle is, for the error and the feedback."""
    for period_ns in (MS, 4 * MS):
        control = Control(tv_s=0.01, derivative="per_cycle")
        assert control.rate(period_ns) == 0.01
    assert Control(tv_s=0.01).rate(2 * MS) == pytest.approx(5.0)


def test_per_cycle_of_the_feedback_is_per_cycle_of_the_error_but_for_the_surface() -> None:
    """No cell of the table: the error of a constant distance changes as its feedback does."""
    seen = 0
    for row in rows("law_table.csv"):
        if row["derivative"] != "per_cycle" or row["period_ms"] != "1":
            continue
        settings = next(s for s in rows("law_settings.csv") if s["setting"] == row["setting"])
        control = Control(
            **{**vars(listed(settings)), "derivative": "per_cycle", "derivative_of": "feedback"}
        )
        loop = loop_of(control, row["mode"], MS, int(row["dead_cycles"] or 0))
        if row["mode"] != "SET_POS":
            assert growth(loop, control.kp) == pytest.approx(float(row["growth"]), abs=5e-5)
        elif not control.tn_s:
            # Nothing of the offset comes back but the offset itself: a pole at 1 - kp
            assert growth(loop, control.kp) == pytest.approx(1.0 - control.kp, abs=1e-9)
        seen += 1
    assert seen == 84
