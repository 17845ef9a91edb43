"""`axisrig tune distance` judges every cell of the table of the law as its poles do.

`tests/oracles/distance/law_table.csv`: spectral radii of an own simulation. What tune identifies is
here an ideal drive: an offset is there `dead_cycles` + 1 cycles later.
"""

import csv
from pathlib import Path

import numpy as np
import pytest

from axisrig.bench.oracles.distance.lists import Control
from axisrig.bench.oracles.distance.smoothing import of_control
from axisrig.bench.tools.tune.loop import (
    Floats,
    Law,
    Loop,
    both_encoders,
    const_dist,
    set_pos,
    without_offset,
)
from axisrig.kernel.time.clock import MS

TABLES = Path(__file__).parents[1] / "oracles" / "distance"


def rows(name: str) -> list[dict[str, str]]:
    return list(csv.DictReader((TABLES / name).read_text(encoding="utf-8").splitlines()))


def delay(cycles: int) -> Floats:
    return np.eye(1, cycles + 1, cycles)[0]


def loop_of(cell: dict[str, str], filtering: Floats, period_s: float) -> Loop:
    cycles = int(cell["dead_cycles"] or 0)
    moved = delay(cycles + 1)
    if cell["mode"] == "CONST_DIST":
        feedback = const_dist(filtering, moved)
    elif cell["mode"] == "both":
        feedback = both_encoders(filtering, delay(cycles + 2), delay(cycles + 2), cycles)
    else:
        feedback = set_pos(filtering, moved, moved)
    is_seen = cell["derivative_of"] == "error" or cell["mode"] != "SET_POS"
    return Loop(
        period_s,
        feedback,
        filtering,
        None if is_seen else without_offset(feedback),
        is_per_cycle=cell["derivative"] == "per_cycle",
    )


@pytest.mark.long
def test_every_cell_is_stable_where_its_growth_is_below_1() -> None:
    settings = {row["setting"]: row for row in rows("law_settings.csv")}
    for cell in rows("law_table.csv"):
        one = settings[cell["setting"]]
        numbers = {key: float(one[key]) for key in ("alpha", "sigma_mm") if one[key]}
        control = Control(filter_type=one["filter_type"], count=int(one["count"]), **numbers)  # type: ignore[arg-type]
        period_s = float(cell["period_ms"]) * 1e-3
        filtering = of_control(control, round(period_s * 1e3) * MS).numerator
        law = Law(float(one["kp"]), float(one["tn_s"]), float(one["tv_s"]))
        is_stable = loop_of(cell, filtering, period_s).is_stable(law)
        assert is_stable == (float(cell["growth"]) < 1.0), cell
