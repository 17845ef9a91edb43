"""Cases of a plan that were read from no file."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from axisrig.bench.plan.case import Case

RIG, OTHER = Path("rig.toml"), Path("foreign.toml")


def case_of(run: str, rig: Path = RIG, line: int = 2, **changes: Any) -> Case:
    made = Case("p", run, f"p-{run}", 0, Path("part.nc"), rig, {}, (), "", (), "", 1, 0,
                Path("p.csv"), line, {})  # fmt: skip
    return replace(made, **changes)
