"""Start values of plants as they act in a row: whose counts, and in which unit."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.tools.budget.starts import start_number, start_value

pytestmark = pytest.mark.interpreted  # stand-ins for settings


def settings(*of_row: str) -> Any:
    """Two plants of a rig; what a row assigns besides."""
    given: dict[str, list[Any]] = {}
    for text in of_row:
        instance = text.removeprefix("plant:").partition(".")[0]
        given.setdefault(instance, []).append((parse_assignment(text), "p.csv:2"))
    plants = {
        "z": SimpleNamespace(start={"position_start_mm": 5, "kv": 40}),
        "x": SimpleNamespace(start={"kv": 30}),
    }
    return SimpleNamespace(rig=SimpleNamespace(plant=plants), start=given)


@pytest.mark.parametrize(
    ("of_row", "z_kv", "x_kv"),
    [
        ((), 40.0, 30.0),
        (("plant:z.kv=41",), 41.0, 30.0),
        (("plant:x.kv=31", "plant:z.position_start_mm=9"), 40.0, 31.0),
        (("plant:z.kv=41", "plant:z.kv=42", "plant:x.kv=0"), 42.0, 0.0),
    ],
)
def test_the_last_value_of_a_row_counts_before_that_of_the_rig(
    of_row: tuple[str, ...], z_kv: float, x_kv: float
) -> None:
    made = settings(*of_row)
    assert start_number(made, "z", "kv", 7.0) == z_kv
    assert start_number(made, "x", "kv", 7.0) == x_kv


def test_a_length_is_in_metres_and_what_nobody_gives_is_the_default() -> None:
    for of_row, metres in ((), 0.005), (("plant:z.position_start_mm=-9",), -0.009):
        assert start_number(settings(*of_row), "z", "position_start", 1.0) == pytest.approx(metres)
    assert start_value(settings(), "x", "position_start") is None
    assert start_number(settings("plant:z.lag=3"), "x", "lag", 1.5) == 1.5
    found = start_value(settings("plant:x.lag=3"), "x", "lag")
    assert found is not None
    assert found.si() == 3.0
