"""What is tried to make a scenario with a finding smaller: fewer faults, shorter windows."""

from collections.abc import Sequence

import pytest

from axisrig.bench.rig.reading.faults import fault_kinds
from axisrig.bench.tools.scenarios.minimise import _shorter, _smaller
from axisrig.bench.tools.scenarios.scenario import Scenario


@pytest.mark.parametrize(
    ("kind", "cell", "shorter"),
    [
        ("delay", "Z.TPDO1 at=edge for=8ms by=1ms", "Z.TPDO1 at=edge for=4000us by=1ms"),
        ("delay", "Z.TPDO1 for=3us", "Z.TPDO1 for=1us"),
        ("drop", "Z.TPDO1 for=2us", "Z.TPDO1 for=1us"),
        ("drop", "Z.TPDO1 for=1us", ""),
        ("delay", "Z.TPDO1 for=1.5s", "Z.TPDO1 for=750000us"),
        ("delay", "Z.TPDO1 at=edge", "Z.TPDO1 at=edge for=1024000us"),
    ],
)
def test_a_window_is_halved_down_to_a_microsecond(kind: str, cell: str, shorter: str) -> None:
    """One without an end gets one of 1.024 s first; its other words stay where they are."""
    assert _shorter(kind, cell) == shorter


def test_a_kind_without_a_window_is_not_shortened() -> None:
    without = [name for name, known in fault_kinds().items() if "for" not in known.keys]
    assert without
    assert [_shorter(name, "Z") for name in without] == [""] * len(without)


def faults(found: Sequence[Scenario]) -> list[tuple[str, ...]]:
    return [one.assignments for one in found]


def test_what_is_tried_is_first_without_a_fault_and_then_with_a_shorter_one() -> None:
    """Other assignments stay in front; faults of one kind share a cell, also the last one."""
    given = Scenario(3, 1, ("fault:delay=A for=2ms; B", "plc:V.E.X=1", "fault:drop=C for=1us"))
    first, *others = faults(list(_smaller(given)))
    assert first == ("plc:V.E.X=1", "fault:delay=B", "fault:drop=C for=1us")
    assert others == [
        ("plc:V.E.X=1", "fault:delay=A for=2ms", "fault:drop=C for=1us"),
        ("plc:V.E.X=1", "fault:delay=A for=2ms; B"),
        ("plc:V.E.X=1", "fault:delay=A for=1000us; B", "fault:drop=C for=1us"),
        ("plc:V.E.X=1", "fault:delay=A for=2ms; B for=1024000us", "fault:drop=C for=1us"),
    ]
    assert {(one.number, one.seed) for one in _smaller(given)} == {(3, 1)}
    assert list(_smaller(Scenario(3, 1, ("plc:V.E.X=1",)))) == []
