"""A variable of a model description, and the texts of findings, for tests without an FMU."""

from collections.abc import Iterable
from types import SimpleNamespace
from typing import Any

from axisrig.bench.tools.fmu.findings import Finding


def texts(findings: Iterable[Finding], level: str = "") -> list[str]:
    return [one.text for one in findings if level in ("", one.level)]


def variable(name: str, **given: Any) -> Any:
    known = {"type": "Float64", "causality": "input", "start": None, "min": None, "max": None,
             "shape": (), "clocks": [], "dimensions": [], "variability": "continuous"}  # fmt: skip
    return SimpleNamespace(name=name, **{**known, **given})
