"""The plans that lie in a folder."""

from collections.abc import Sequence
from pathlib import Path

from axisrig.bench.plan.table import SUFFIXES
from axisrig.kernel.errors import UserError


def plans_in(folder: Path) -> list[Path]:
    """Return every table that lies directly in a plan folder, by name."""
    if not folder.is_dir():
        raise UserError(
            "no folder with plans here",
            file=folder,
            hint="run it in a checkout of axisrig, or name one with --plans",
        )
    plans = sorted(path for path in folder.iterdir() if path.suffix.lower() in SUFFIXES)
    if not plans:
        raise UserError("the folder holds no plan", file=folder, allowed=" ".join(SUFFIXES))
    return plans


def with_plans_in(paths: Sequence[Path]) -> list[Path]:
    """Return files as they are, and in place of a folder the plans that lie in it."""
    return [plan for path in paths for plan in (plans_in(path) if path.is_dir() else [path])]
