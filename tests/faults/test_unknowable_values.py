"""Which wrong values no control can know: those that follow from what its segments brought.

By hand: a row each millisecond, the telegram 200 us after it, the NC cycle at 600 us, a PLC of 1 ms
at a terminal of 1 ms. The edge at 30 ms is read in the cycle of 31.6 ms, whose SYNC is row 31.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from tests.faults.made_runs import PER_MM, STEP_MM, left, run

from axisrig.bench.machine.recording.received import Received, Telegram
from axisrig.bench.record.axes import Edge, ProbeRecord
from axisrig.bench.record.edges import EdgeTruth
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.bench.record.series import Series
from axisrig.bench.tools.scenarios.campaign import run_scenario
from axisrig.bench.tools.scenarios.left import Left
from axisrig.bench.tools.scenarios.oracle import DEFECTS, Result, judge
from axisrig.bench.tools.scenarios.scenario import make_scenario
from axisrig.kernel.time.clock import MS, US

ROWS, AT_EDGE, OFF_MM = 100, 31, 0.01
TRUE_MM = [0.02 * row for row in range(ROWS)]
Places = Mapping[int, Sequence[tuple[int, float]]]
"""By row what comes instead of its telegram: so many us after the SYNC, and the position."""


def telegrams(instead: Places, true_mm: Sequence[float] = TRUE_MM) -> list[Telegram]:
    found = []
    for row, mm in enumerate(true_mm):
        for after_us, place_mm in instead.get(row, [(200, mm)]):
            increments = round(place_mm * PER_MM)
            found.append((row * MS + after_us * US, increments.to_bytes(4, "little", signed=True)))
    return found


def touched(
    value_mm: float,
    instead: Places | None = None,
    *,
    doubt_mm: float = 0.0,
    true_mm: Sequence[float] = TRUE_MM,
) -> Left:
    """A run whose value is of a signal at the PLC."""
    doubts = {"Z": doubt_mm} if doubt_mm else {}
    record = replace(run(25, 40, value_mm, doubt_mm=doubts), sources={"Z": "PLC"})
    made = left(
        "source-plc",
        true_mm,
        runs=(record,),
        probes={"probe": ProbeRecord(True, 0.0, edges=(Edge(30 * MS + 7, True),))},
        plc_task=PlcTaskRecord(MS, 0, 0, MS, 0, probes=("probe",)),
    )
    return replace(made, received=received(telegrams(instead or {}, true_mm)))


def received(positions: list[Telegram]) -> Received:
    return Received(
        {"Z": positions}, {"Z": lambda data: int.from_bytes(data, "little", signed=True)}
    )


WRONG_MM = TRUE_MM[AT_EDGE] + OFF_MM
ALTERED = (200, WRONG_MM)
CASES: dict[str, tuple[Left, Result]] = {
    "right": (touched(TRUE_MM[AT_EDGE]), Result.GOOD),
    "altered on its way": (touched(WRONG_MM, {AT_EDGE: [ALTERED]}), Result.UNKNOWABLE),
    "altered alike, twice": (
        touched(WRONG_MM, {AT_EDGE: [ALTERED, (300, WRONG_MM)]}),
        Result.UNKNOWABLE,
    ),
    "that of a cycle before": (
        touched(TRUE_MM[AT_EDGE - 1], {AT_EDGE: [(200, TRUE_MM[AT_EDGE - 1])]}),
        Result.UNKNOWABLE,
    ),
    "wrong by itself": (touched(WRONG_MM), Result.BROKEN),
    "wrong by more than it was altered": (
        touched(WRONG_MM + 3 * STEP_MM, {AT_EDGE: [ALTERED]}),
        Result.BROKEN,
    ),
    "another telegram was altered": (touched(WRONG_MM, {AT_EDGE - 1: [ALTERED]}), Result.BROKEN),
    "two that differ, the later believed": (
        touched(WRONG_MM, {AT_EDGE: [(200, TRUE_MM[AT_EDGE]), (300, WRONG_MM)]}),
        Result.BROKEN,
    ),
    "after the NC cycle": (touched(WRONG_MM, {AT_EDGE: [(700, WRONG_MM)]}), Result.BROKEN),
    "missing, between right ones": (touched(WRONG_MM, {AT_EDGE: []}), Result.BROKEN),
    "missing, with its doubt": (touched(WRONG_MM, {AT_EDGE: []}, doubt_mm=OFF_MM), Result.GOOD),
    "missing, beside what is brought by no more than its doubt": (
        touched(
            WRONG_MM + 2 * STEP_MM,
            {AT_EDGE: []} | {n: [(200, TRUE_MM[n] + OFF_MM)] for n in range(ROWS) if n != AT_EDGE},
            doubt_mm=2 * STEP_MM,
        ),
        Result.UNKNOWABLE,
    ),
    "missing, beside what is brought by more than its doubt": (
        touched(
            WRONG_MM + 4 * STEP_MM,
            {AT_EDGE: []} | {n: [(200, TRUE_MM[n] + OFF_MM)] for n in range(ROWS) if n != AT_EDGE},
            doubt_mm=2 * STEP_MM,
        ),
        Result.BROKEN,
    ),
    "missing, between ones that are off alike": (
        touched(
            WRONG_MM,
            {AT_EDGE: []} | {n: [(200, TRUE_MM[n] + OFF_MM)] for n in range(ROWS) if n != AT_EDGE},
        ),
        Result.UNKNOWABLE,
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_value_is_excused_by_what_was_brought_alone(case: str) -> None:
    made, result = CASES[case]
    assert judge(made).result is result


def test_a_value_is_excused_whatever_else_cannot_be_decided() -> None:
    """Only a hidden value itself is none to be excused."""
    made, _ = CASES["altered on its way"]
    for hidden, result in (
        ({"rest", "stop"}, Result.UNKNOWABLE), ({"value"}, Result.GOOD),
        ({"value", "rest"}, Result.GOOD),
    ):  # fmt: skip
        assert judge(replace(made, hidden=frozenset(hidden))).result is result


def test_what_lies_in_a_gap_of_positions_is_no_part_of_what_was_brought() -> None:
    """A kink in the gap, all others off alike: the doubt is the control's; its cubic is 0.5 um off.

    The weights of the cubic at the missing place are -1/6, 2/3, 2/3, -1/6; of a kink of 3 mm/s, one
    cycle before, it shows (2 2/3 - 3 1/6) of its 3 um.
    """
    kink_mm = 0.003
    true_mm = [mm + kink_mm * max(row - AT_EDGE + 1, 0) for row, mm in enumerate(TRUE_MM)]
    alike: Places = {AT_EDGE: []} | {
        row: [(200, true_mm[row] + OFF_MM)] for row in range(ROWS) if row != AT_EDGE
    }
    of_cubic_mm = true_mm[AT_EDGE] + OFF_MM + kink_mm * (2 * 2 / 3 - 3 / 6 - 1)
    for value_mm, result in (
        (true_mm[AT_EDGE] + OFF_MM, Result.UNKNOWABLE),
        (of_cubic_mm, Result.BROKEN),
    ):
        assert judge(touched(value_mm, alike, true_mm=true_mm)).result is result


def test_without_a_listener_nothing_is_excused() -> None:
    made = replace(touched(WRONG_MM, {AT_EDGE: [ALTERED]}), received=None)
    assert judge(made).result is Result.BROKEN


AFTER_US, PER_US_MM = 64, 0.02e-3
"""The SYNC of the segment of the axis is so late; so far it goes in a microsecond."""


@pytest.mark.parametrize(
    ("off_mm", "brought_off_mm", "result"),
    [
        (0.0, 0.0, Result.GOOD),
        (OFF_MM, OFF_MM, Result.UNKNOWABLE),
        (-AFTER_US * PER_US_MM, 0.0, Result.BROKEN),  # where it was at the first SYNC
        (OFF_MM, 0.0, Result.BROKEN),
    ],
)
def test_a_position_is_brought_of_the_sync_of_its_own_segment(
    off_mm: float, brought_off_mm: float, result: Result
) -> None:
    """The truth of a row is of the first SYNC; the drive samples at its own."""
    own_mm = [mm + AFTER_US * PER_US_MM for mm in TRUE_MM]
    made = touched(own_mm[AT_EDGE] + off_mm)
    series = made.series.table().append_column(
        "Z.sync_after_ns", pa.array([AFTER_US * US] * ROWS, pa.int64())
    )
    places = [mm + brought_off_mm * (row == AT_EDGE) for row, mm in enumerate(own_mm)]
    brought = received(telegrams({}, places))
    assert judge(replace(made, series=Series(series), received=brought)).result is result


@pytest.mark.parametrize(("off_mm", "result"), [(0.0, Result.GOOD), (OFF_MM, Result.UNKNOWABLE)])
def test_what_lies_around_a_gap_is_brought_of_the_syncs_of_its_own_segment(
    off_mm: float, result: Result
) -> None:
    """All others are off alike of where the axis was at their own SYNCs, 1.28 um after the row."""
    own_mm = [mm + AFTER_US * PER_US_MM for mm in TRUE_MM]
    made = touched(own_mm[AT_EDGE] + off_mm)
    series = made.series.table().append_column(
        "Z.sync_after_ns", pa.array([AFTER_US * US] * ROWS, pa.int64())
    )
    gap: Places = {AT_EDGE: []}
    brought = received(telegrams(gap, [mm + off_mm for mm in own_mm]))
    assert judge(replace(made, series=Series(series), received=brought)).result is result


@pytest.mark.parametrize(
    ("late", "result"), [(AT_EDGE, Result.GOOD), (36, Result.UNKNOWABLE)], ids=["in time", "late"]
)
def test_a_level_that_comes_late_moves_the_value(late: int, result: Result) -> None:
    """The node sends the level of its SYNC; where it comes later the value is that of then."""
    made = touched(TRUE_MM[late])
    task = PlcTaskRecord(MS, 550_000, 0, MS, 0, probes=("probe",), terminal_late_ns=200 * US)
    probe = ProbeRecord(True, 0.0, edges=(Edge((AT_EDGE - 1) * MS + 7, True),))
    facts = replace(made.facts, plc_task=task, probes={"probe": probe})
    assert made.received is not None
    made.received.inputs += [(row * MS + 200 * US, bytes([row >= late])) for row in range(ROWS)]
    assert judge(replace(made, facts=facts)).result is result


def test_each_of_two_runs_is_excused_by_its_own_edge() -> None:
    """The first of 25 to 40 ms, the second of 60 to 80 ms with its edge at 65 ms (row 66)."""
    edges = (Edge(30 * MS + 7, True), Edge(50 * MS, False), Edge(65 * MS + 7, True))
    for first_mm, second_mm, instead in (
        (WRONG_MM, TRUE_MM[66], {AT_EDGE: [ALTERED]}),
        (TRUE_MM[AT_EDGE], TRUE_MM[66] + OFF_MM, {66: [(200, TRUE_MM[66] + OFF_MM)]}),
    ):
        made = touched(first_mm, instead)
        second = replace(run(60, 80, second_mm), sources={"Z": "PLC"})
        probes = {"probe": ProbeRecord(True, 0.0, edges=edges)}
        facts = replace(made.facts, runs=(*made.facts.runs, second), probes=probes)
        assert judge(replace(made, facts=facts)).result is Result.UNKNOWABLE
        assert judge(replace(made, facts=facts, received=received(telegrams({})))).result is (
            Result.BROKEN
        )


def test_after_homing_telegrams_count_from_the_reference() -> None:
    """G74 at 5 ms has set 3 mm of the plant to 0."""
    made = touched(WRONG_MM - 3.0)
    axes = {"Z": replace(made.facts.axes["Z"], homed_ns=(5 * MS,), origin_mm=3.0)}
    made = replace(made, facts=replace(made.facts, axes=axes))
    places = [mm - 3.0 for mm in TRUE_MM]
    for off_mm, result in ((OFF_MM, Result.UNKNOWABLE), (0.0, Result.BROKEN)):
        brought = telegrams({AT_EDGE: [(200, places[AT_EDGE] + off_mm)]}, places)
        assert judge(replace(made, received=received(brought))).result is result


@pytest.mark.parametrize(
    ("first_us", "result"), [(0, Result.UNKNOWABLE), (100, Result.UNKNOWABLE),
                             (200, Result.UNKNOWABLE), (201, Result.BROKEN)],
)  # fmt: skip
def test_a_telegram_that_comes_before_an_answer_is_possible_brings_nothing(
    first_us: int, result: Result
) -> None:
    """They end 200 us after their SYNCs; where an answer takes longer they are none."""
    made = touched(WRONG_MM, {AT_EDGE: [ALTERED]})
    assert made.received is not None
    made.received.first_ns["Z"] = first_us * US
    assert judge(made).result is result


def test_a_telegram_too_early_to_be_an_answer_is_none_beside_the_right_one() -> None:
    """Two answers that differ prove nothing; one of them alone counts."""
    early, late = (30, TRUE_MM[AT_EDGE]), ALTERED
    for first_us, result in ((0, Result.BROKEN), (50, Result.UNKNOWABLE)):
        made = touched(WRONG_MM, {AT_EDGE: [early, late]})
        assert made.received is not None
        made.received.first_ns["Z"] = first_us * US
        assert judge(made).result is result


def test_without_homing_telegrams_count_from_where_the_drive_does() -> None:
    """The drive counts from 3 mm of the plant, and the control with it: nothing was set anew."""
    made = touched(WRONG_MM, {AT_EDGE: [ALTERED]})
    axes = {"Z": replace(made.facts.axes["Z"], origin_mm=3.0)}
    assert judge(replace(made, facts=replace(made.facts, axes=axes))).result is Result.UNKNOWABLE


def levels(made: Left, highs: Sequence[range], **of_record: object) -> Left:
    """The run with a node whose level is up in some rows."""
    task = PlcTaskRecord(MS, 550_000, 0, MS, 0, probes=("probe",), terminal_late_ns=200 * US)
    probe = ProbeRecord(True, 0.0, edges=(Edge((AT_EDGE - 1) * MS + 7, True),))
    runs = tuple(replace(each, **of_record) for each in made.facts.runs)  # type: ignore[arg-type]
    facts = replace(made.facts, plc_task=task, probes={"probe": probe}, runs=runs)
    assert made.received is not None
    made.received.inputs += [
        (row * MS + 200 * US, bytes([any(row in up for up in highs)])) for row in range(ROWS)
    ]
    return replace(made, facts=facts)


@pytest.mark.parametrize(
    ("highs", "result"),
    [
        ([range(36, ROWS)], Result.UNKNOWABLE),
        ([range(10, 15), range(36, ROWS)], Result.UNKNOWABLE),  # before the run: 20 to 40 ms
        ([range(22, 24), range(36, ROWS)], Result.BROKEN),  # the first one within it
        ([range(5), range(36, ROWS)], Result.UNKNOWABLE),  # up as it begins
        ([range(41, ROWS)], Result.BROKEN),  # after the run
        ([], Result.BROKEN),
    ],
)
def test_the_level_that_counts_is_the_first_edge_within_its_run(
    highs: list[range], result: Result
) -> None:
    assert judge(levels(touched(TRUE_MM[36]), highs)).result is result


@pytest.mark.parametrize("first_up", [range(26, 26), range(26, 28)])
def test_the_first_level_that_is_brought_is_no_edge(first_up: range) -> None:
    """The listener hears the node from row 26 on, within the run: up or down as it begins."""
    made = levels(touched(TRUE_MM[36]), [first_up, range(36, ROWS)])
    assert made.received is not None
    del made.received.inputs[:26]
    assert judge(made).result is Result.UNKNOWABLE


def test_the_way_of_a_telegram_is_in_its_end_already() -> None:
    """A level that has come 200 us after its SYNC is in the PLC cycle at 550 us, in 400 us too."""
    made = levels(touched(TRUE_MM[36]), [range(36, ROWS)])
    assert made.facts.plc_task is not None
    for late_us in (200, 400):
        task = replace(made.facts.plc_task, terminal_late_ns=late_us * US)
        facts = replace(made.facts, plc_task=task)
        assert judge(replace(made, facts=facts)).result is Result.UNKNOWABLE


@pytest.mark.parametrize(("edge", "result"), [("POS", Result.UNKNOWABLE), ("NEG", Result.BROKEN)])
def test_the_level_has_the_edge_that_the_list_of_the_axis_wants(edge: str, result: Result) -> None:
    """Up in row 36, down again in row 38: P-AXIS-00518 says which of both counts."""
    made = levels(touched(TRUE_MM[36]), [range(36, 38)])
    record = made.facts.axes["Z"]
    axes = {"Z": replace(record, written={**record.written, "kenngr.measure.edge": edge})}
    probe = ProbeRecord(True, 0.0, edges=(Edge((AT_EDGE - 1) * MS + 7, edge == "POS"),))
    facts = replace(made.facts, axes=axes, probes={"probe": probe})
    assert judge(replace(made, facts=facts)).result is result
    falling = levels(touched(TRUE_MM[38]), [range(36, 38)])
    facts = replace(falling.facts, axes=axes, probes={"probe": probe})
    at_38 = Result.UNKNOWABLE if edge == "NEG" else Result.BROKEN
    assert judge(replace(falling, facts=facts)).result is at_38


KINK_MM = 0.0005
COURSE_MM = [*TRUE_MM[:31], *(TRUE_MM[row] + KINK_MM * (row - 30) for row in range(31, ROWS))]
AT_HALF_MM = float(np.array([-1, 9, 9, -1]) @ COURSE_MM[29:33]) / 16
"""The cubic through the four positions around 30.5 ms (Lagrange, evenly spaced)."""


@pytest.mark.parametrize(
    ("value_mm", "result"),
    [
        (AT_HALF_MM, Result.UNKNOWABLE),
        (AT_HALF_MM + 3 * STEP_MM, Result.BROKEN),
        (COURSE_MM[30] + 0.01, Result.GOOD),
    ],
    ids=["of the cubic", "beside it", "true"],
)
def test_what_positions_at_syncs_do_not_show_of_a_stamp(value_mm: float, result: Result) -> None:
    """The axis goes on at its old speed until 30.5 ms, and faster after that."""
    true_mm = COURSE_MM[30] + 0.01
    edge_ns = 30 * MS + 500 * US
    truth = EdgeTruth("probe", "Z", True, edge_ns, true_mm, true_mm, edge_ns, true_mm, true_mm)
    record = replace(run(25, 40, value_mm), sources={"Z": "PLC_TIMESTAMP"})
    made = left(
        "source-stamp",
        COURSE_MM,
        runs=(record,),
        probes={"probe": ProbeRecord(True, 0.0, edges=(Edge(edge_ns, True),))},
        plc_task=PlcTaskRecord(MS, 0, 0, MS, 0, probes=("probe",)),
        edges=(truth,),
    )
    made = replace(made, received=received(telegrams({}, COURSE_MM)))
    assert judge(made).result is result


FOUND = {
    "source-node": (448, 987, 1464, 1849, 1950),
    "source-plc": (1629,),
    "source-stamp": (758, 1677),
    "ethercat-stamp": (982,),
    "homing": (199, 497),
}
"""Scenarios of seed 1 that were findings (docs/reliability.md)."""


@pytest.mark.long
@pytest.mark.parametrize(
    ("machine", "number"), [(name, n) for name, numbers in FOUND.items() for n in numbers]
)
def test_what_was_found_is_mended_or_foretold(machine: str, number: int) -> None:
    judgement = run_scenario(make_scenario(1, number, machine))
    assert judgement.result not in DEFECTS, judgement.note
