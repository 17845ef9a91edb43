"""Metrics of the user: a Python file beside the plan, or an entry point, named in `module`.

Each function `metric_<name>(recording)` is a metric `<name>`. A plan reads the names only; the file
runs where a recording is judged (`axisrig.bench.judge.own_metrics`).
"""

import ast
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from axisrig.bench.plan.checks import Metric, known_metrics
from axisrig.bench.plan.composition import existing
from axisrig.bench.plan.table import Cell
from axisrig.kernel.errors import UserError, nearest

PREFIX = "metric_"
GROUP = "axisrig.metrics"
"""Group of entry points; one names a module, or an object with such functions."""
SUFFIX = ".py"


@dataclass(frozen=True)
class OwnModule:
    """Where metrics of the user are.

    path: of the file, None for an entry point. name: of the entry point, else of the file.
    metrics: by name.
    """

    name: str
    path: Path | None
    metrics: Mapping[str, Metric]

    def text_in(self, folder: Path) -> str:
        """Write it as a cell of a plan in `folder`."""
        if self.path is None:
            return self.name
        inside = self.path.is_relative_to(folder)
        return (self.path.relative_to(folder) if inside else self.path).as_posix()


def own_module(cell: Cell) -> OwnModule:
    """Find the metrics of a cell `module`.

    Raises UserError for a file that is missing, that is no Python, or that has no metric, for one
    that has the name of a metric of axisrig, and for an unknown entry point.
    """
    if not cell.text.endswith(SUFFIX):
        return _of_entry_point(cell)
    path = existing(cell, "module")
    try:
        tree = ast.parse(path.read_bytes(), str(path))
    except (SyntaxError, ValueError) as error:
        line = error.lineno if isinstance(error, SyntaxError) else None
        message = error.msg if isinstance(error, SyntaxError) else str(error)
        raise UserError(
            f"the module cannot be read: {message}"
            f" ({cell.place.file.name}:{cell.place.line}, {cell.place.words})",
            file=path,
            line=line,
        ) from None
    functions = [item for item in tree.body if isinstance(item, ast.FunctionDef)]
    lines = {
        item.name.removeprefix(PREFIX): (item.lineno, ast.get_docstring(item) or "")
        for item in functions
        if item.name.startswith(PREFIX)
    }
    for name, (line, _) in lines.items():
        if name in known_metrics():
            raise UserError(
                f"axisrig has a metric of this name ({cell.place.words})",
                file=path,
                line=line,
                value=name,
            )
    if not lines:
        raise cell.place.error(
            "the module has no metric", value=cell.text, hint=f"def {PREFIX}<name>(recording): ..."
        )
    found = {name: _metric(name, text, f"{path}:{line}") for name, (line, text) in lines.items()}
    return OwnModule(path.name, path, found)


def _of_entry_point(cell: Cell) -> OwnModule:
    points = metadata.entry_points(group=GROUP)
    if cell.text not in points.names:
        raise cell.place.error(
            "no Python file, and no entry point of this name is installed",
            value=cell.text,
            allowed=nearest(cell.text, points.names) or sorted(points.names) or "a file *.py",
            hint=f"entry points are those of the group {GROUP}",
        )
    try:
        loaded = points[cell.text].load()
    except Exception as error:  # whatever the import of somebody else's module raises
        raise cell.place.error(
            f"the entry point cannot be loaded: {type(error).__name__}: {error}", value=cell.text
        ) from None
    found = {
        name.removeprefix(PREFIX): getattr(loaded, name)
        for name in dir(loaded)
        if name.startswith(PREFIX)
    }
    metrics = {
        name: _metric(name, function.__doc__ or "", cell.text)
        for name, function in found.items()
        if name not in known_metrics()
    }
    if not metrics:
        raise cell.place.error("the entry point has no metric of its own", value=cell.text)
    return OwnModule(cell.text, None, metrics)


def _metric(name: str, meaning: str, source: str) -> Metric:
    """A metric whose unit and type its function says when it is called."""
    return Metric(
        name=name,
        scope="run",
        type="any",
        unit="",
        plot="",
        needs="",
        judged="",
        words="",
        meaning=meaning.partition("\n")[0],
        source=source,
    )
