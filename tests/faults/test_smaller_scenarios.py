"""What is tried to make a scenario with a finding smaller: fewer faults, shorter windows."""

from collections.abc import Sequence

import pytest

from axisrig.bench.rig.reading.faults import fault_kinds
from axisrig.bench.tools.scenarios.minimise import (
    _shorter,
    _smaller,
    faults_of,
    is_same,
    minimised,
)
from axisrig.bench.tools.scenarios.oracle import Judgement, Result
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


BROKEN, ALARM, HANG, DIED = Result.BROKEN, Result.ALARM, Result.HANG, Result.EXCEPTION


@pytest.mark.parametrize(
    ("first", "second", "same"),
    [
        (Judgement(BROKEN, broken=("rest",)), Judgement(BROKEN, broken=("rest",)), True),
        (Judgement(BROKEN, broken=("rest",)), Judgement(BROKEN, broken=("stop",)), False),
        (Judgement(BROKEN, broken=("rest", "stop")), Judgement(BROKEN, broken=("rest",)), False),
        (Judgement(BROKEN, broken=("rest",)), Judgement(ALARM, broken=("rest",)), False),
        (
            Judgement(BROKEN, note="rest: Z 2 mm", broken=("rest",)),
            Judgement(BROKEN, note="other: X", broken=("rest",), alarms=[7], right=2, frames="f"),
            True,
        ),
        (Judgement(HANG, note="1 s: at N10"), Judgement(HANG, note="2 s: at N30"), True),
        (Judgement(HANG), Judgement(DIED), False),
        (Judgement(DIED, note="KeyError: 3"), Judgement(DIED, note="KeyError: 4"), True),
        (Judgement(DIED, note="KeyError: 3"), Judgement(DIED, note="TypeError: 3"), False),
    ],
)
def test_a_finding_is_the_same_by_result_and_invariants_and_by_the_type_of_an_exception(
    first: Judgement, second: Judgement, same: bool
) -> None:
    assert is_same(first, second) is same
    assert is_same(second, first) is same


def test_the_faults_of_a_scenario_have_their_kinds_in_their_order() -> None:
    texts = ("plc:V.E.X=1", "fault:delay=A for=2ms; B by=1ms", "fault:drop=C")
    assert faults_of(Scenario(3, 1, texts)) == [
        ("delay", "A for=2ms"), ("delay", "B by=1ms"), ("drop", "C"),
    ]  # fmt: skip
    assert faults_of(Scenario(3, 1, texts[:1])) == []


def test_a_scenario_is_made_as_small_as_still_shows_its_finding() -> None:
    """It needs B, and a window of A of 3 ms: 8 ms are halved once, C is left out."""
    tried: list[tuple[str, ...]] = []

    def run(one: Scenario) -> Judgement:
        tried.append(one.faults)
        cells = dict(reversed(fault) for fault in faults_of(one))
        windows = [cell for cell in cells if cell.startswith("A for=")]
        long = windows and float(windows[0].removeprefix("A for=").rstrip("usm")) >= 3000
        shows = bool(long) and any(cell.startswith("B") for cell in cells)
        return (
            Judgement(BROKEN, broken=("stop",), frames=str(len(tried)), note=" ".join(cells))
            if shows
            else Judgement(ALARM)
        )

    whole = Scenario(3, 1, ("plc:V.E.X=1", "fault:delay=A for=8000us; B for=1us", "fault:drop=C"))
    best, judgement = minimised(whole, Judgement(BROKEN, broken=("stop",), note="first"), run)
    assert best.assignments == ("plc:V.E.X=1", "fault:delay=A for=4000us; B for=1us")
    assert judgement.note == "A for=4000us B for=1us"
    assert tried[-1] == ("fault:delay=A for=2000us; B for=1us",), "the next one, which shows none"


def test_a_scenario_that_no_smaller_one_shows_stays_with_its_judgement() -> None:
    whole = Scenario(3, 1, ("fault:drop=C",))
    judgement = Judgement(BROKEN, broken=("stop",), note="first")
    assert minimised(whole, judgement, lambda _: Judgement(ALARM)) == (whole, judgement)
