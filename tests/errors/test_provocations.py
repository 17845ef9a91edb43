"""Every alarm that something can raise is raised by a test, and only those are marked so."""

import ast
import csv
import io
from pathlib import Path

import pytest

import axisrig.bench
import axisrig.kernel
from axisrig.kernel.errors import catalogue

KERNEL, BENCH = Path(axisrig.kernel.__path__[0]), Path(axisrig.bench.__path__[0])
CATALOGUE = KERNEL / "errors.csv"


def _ids_in_use() -> dict[int, list[str]]:
    """Places of every number of the sources and of the kernel's tables that is an alarm ID."""
    places: dict[int, list[str]] = {}
    for path in sorted([*KERNEL.rglob("*.py"), *BENCH.rglob("*.py")]):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and type(node.value) is int:
                places.setdefault(node.value, []).append(f"{path.name}:{node.lineno}")
    for path in sorted(set(KERNEL.rglob("*.csv")) - {CATALOGUE}):
        table = csv.DictReader(io.StringIO(path.read_text(encoding="utf-8")))
        for row in table:
            words = f"{row.get('alarm') or ''} {row.get('correction') or ''}".split()
            for word in filter(str.isdigit, words):
                places.setdefault(int(word), []).append(f"{path.name}:{table.line_num}")
    return {number: at for number, at in places.items() if number in catalogue()}


@pytest.mark.long
def test_what_is_raised_is_marked_so() -> None:
    unmarked = {i: at for i, at in _ids_in_use().items() if not catalogue()[i].is_raised}
    assert unmarked == {}, "set `raised` of kernel/axisrig/kernel/errors.csv to yes"


@pytest.mark.long
def test_what_is_marked_so_is_raised() -> None:
    in_use = _ids_in_use()
    assert [i for i, entry in catalogue().items() if entry.is_raised and i not in in_use] == []


def test_every_alarm_that_can_come_up_is_provoked_by_a_test(unprovoked: list[int]) -> None:
    """`@pytest.mark.provokes(id, class, value=...)` over a test says so: tests/conftest.py."""
    assert unprovoked == []
