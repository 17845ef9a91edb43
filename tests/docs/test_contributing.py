"""CONTRIBUTING prints the rooms and limits that the architecture tests enforce."""

from pathlib import Path

from tests.architecture import test_architecture as rules
from tests.architecture import test_every_module as limits_of

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "CONTRIBUTING.md").read_text("utf-8")


def printed(root: str) -> list[list[str]]:
    (line,) = (line for line in PAGE.splitlines() if line.startswith(f"    {root} "))
    return [group.strip().split(", ") for group in line.removeprefix(f"    {root}").split("|")]


def test_the_rooms_are_in_the_order_that_is_enforced() -> None:
    for root in ("kernel", "bench"):
        others = {"axisrig.reports": "(reports)", "axisrig.results": "(results)"}
        other = others if root == "bench" else {}
        groups = [
            [other.get(name, name.rpartition(".")[2]) for name in names]
            for names in rules.ORDER
            if names[0].startswith(f"axisrig.{root}.") or names[0] in other
        ]
        assert printed(root) == groups


def test_the_rooms_of_the_exporter() -> None:
    rooms = [name.rpartition(".")[2] for name in rules.FMUS_ORDER if not name.endswith("errors")]
    assert printed("fmus") == [[room] for room in rooms]


def test_the_limits_are_those_of_the_test() -> None:
    lines, of_function = limits_of.MODULE_LINES_MAX, limits_of.FUNCTION_LINES_MAX
    limits = f"at most {lines} lines, a function {of_function}"
    assert limits in PAGE
