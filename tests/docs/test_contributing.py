"""CONTRIBUTING prints the rooms and limits that the architecture test enforces."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "CONTRIBUTING.md").read_text("utf-8")


@pytest.fixture(scope="module")
def rules() -> ModuleType:
    path = ROOT / "tests" / "architecture" / "test_architecture.py"
    spec = importlib.util.spec_from_file_location("architecture_rules", path)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def printed(root: str) -> list[list[str]]:
    (line,) = (line for line in PAGE.splitlines() if line.startswith(f"    {root} "))
    return [group.strip().split(", ") for group in line.removeprefix(f"    {root}").split("|")]


def test_the_rooms_are_in_the_order_that_is_enforced(rules: ModuleType) -> None:
    for root in ("kernel", "bench"):
        other = {"axisrig.reports": "(reports)"} if root == "bench" else {}
        groups = [
            [other.get(name, name.rpartition(".")[2]) for name in names]
            for names in rules.ORDER
            if names[0].startswith(f"axisrig.{root}.") or names[0] in other
        ]
        assert printed(root) == groups


def test_the_rooms_of_the_exporter(rules: ModuleType) -> None:
    rooms = [name.rpartition(".")[2] for name in rules.FMUS_ORDER if not name.endswith("errors")]
    assert printed("fmus") == [[room] for room in rooms]


def test_the_limits_are_those_of_the_test(rules: ModuleType) -> None:
    limits = f"at most {rules.MODULE_LINES_MAX} lines, a function {rules.FUNCTION_LINES_MAX}"
    assert limits in PAGE
