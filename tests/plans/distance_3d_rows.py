"""The rows of testplans/distance_3d.csv, with what follows from their inputs."""

import csv
import io
import math
import re
from pathlib import Path

import numpy as np
from tests.plans import distance_3d_law as law

from axisrig.bench.plan.expanded import expanded_text
from axisrig.bench.plan.plan import read_plan

PLANS = Path(__file__).parents[2] / "testplans"
NUMBER = r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"


class Row:
    """A row of the plan: inputs and checks by name, with what follows from them."""

    def __init__(self, cells: dict[str, str]) -> None:
        self.cells = cells
        self.case, self.tags = cells["case"], cells["tags"].split()
        self.program = Path(cells["program"]).stem.removeprefix("distance-3d").strip("-")
        self.checks = {
            name.removeprefix("check:"): cell
            for name, cell in cells.items()
            if name.startswith("check:") and cell
        }

    def number(self, name: str, otherwise: float = 0.0) -> float:
        """Return an input."""
        cell = self.cells.get(name, "")
        return float(cell) if cell else otherwise

    def at(self, plant: str) -> float:
        """Return where an axis starts, mm or degrees."""
        ends = ("position_start_mm", "position_start_deg")
        return sum(self.number(f"plant:{plant}.{end}") for end in ends)

    def ve(self, name: str, otherwise: float = 0.0) -> float:
        """Return a V.E. variable."""
        return self.number(f"plc:V.E.{name}", otherwise)

    def listed(self, name: str, otherwise: float) -> float:
        """Return a parameter of the control."""
        return self.number(f"set:channel.dist_ctrl[0].{name}", otherwise)

    @property
    def mode(self) -> int:
        """1 ACS, 2 ECS, 3 MCS."""
        found = int(self.ve("LAW"))
        return found // 10 if found > 9 else found

    @property
    def is_const(self) -> bool:
        """Whether the law is CONST_DIST."""
        return self.ve("LAW") in (12, 22, 32, 42)

    @property
    def dead(self) -> int:
        """Dead cycles of the loop."""
        late = 2 if self.cells["rig"].endswith("late.toml") else 0
        return 2 - int(self.listed("optimized_scheduling", 0)) + late

    @property
    def kp(self) -> float:
        return self.listed("kp", 0.2)

    @property
    def lift(self) -> float:
        return self.number("plant:gap.lift_mm")

    def way(self, deviation: float, a: float) -> law.Vector:
        """Return the way of the tool for a deviation."""
        if self.mode == 2:
            return law.along_tool(deviation, self.at("c"), a)
        return np.array((0.0, 0.0, deviation))


def _rows() -> dict[str, Row]:
    text = expanded_text(read_plan(PLANS / "distance_3d.csv"))
    return {cells["case"]: Row(cells) for cells in csv.DictReader(io.StringIO(text))}


ROWS = _rows()


def band(cell: str) -> tuple[float, float]:
    """Return lower and upper end of a condition."""
    if match := re.fullmatch(rf"({NUMBER}) \+- ({NUMBER})", cell):
        return float(match[1]) - float(match[2]), float(match[1]) + float(match[2])
    if match := re.fullmatch(rf"({NUMBER}) \.\. ({NUMBER})", cell):
        return float(match[1]), float(match[2])
    match = re.fullmatch(rf"(<=|>=|==) ({NUMBER})", cell)
    assert match, cell
    value = float(match[2])
    return {"<=": (-math.inf, value), ">=": (value, math.inf), "==": (value, value)}[match[1]]
