"""What a signal at the PLC was brought, and invariants beside another axis, control or sign.

By hand: a row each millisecond, the telegram 200 us after it, the NC cycle at 600 us.
"""

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.faults.made_runs import (
    CONTROLLER,
    LISTS,
    PER_MM,
    STEP_MM,
    edge,
    found,
    left,
    run,
)

from axisrig.bench.judge.latch.truth import touch
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.machine.recording.received import Received, Telegram
from axisrig.bench.record.axes import Edge, ProbeRecord
from axisrig.bench.record.distance import DistanceChange, DistanceRecord
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.bench.tools.scenarios.brought import _at, predicted_mm
from axisrig.bench.tools.scenarios.drawing import draw_inputs
from axisrig.bench.tools.scenarios.invariants import is_unknowable
from axisrig.bench.tools.scenarios.left import Left
from axisrig.bench.tools.scenarios.machines import path_of
from axisrig.bench.tools.scenarios.minimise import _with, faults_of
from axisrig.bench.tools.scenarios.oracle import Result, judge
from axisrig.bench.tools.scenarios.scenario import Scenario
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

ROWS = 100
TRUE_MM = [0.02 * row for row in range(ROWS)]
"""20 mm/s throughout."""
OFF_MM = 0.01
INCREMENTS: Callable[[bytes], int] = lambda data: int.from_bytes(data, "little", signed=True)  # noqa: E731


def positions(off_mm: dict[int, float], rows: range = range(ROWS)) -> list[Telegram]:
    """A telegram for each row, off by so much in some."""
    return [
        (
            row * MS + 200 * US,
            round((TRUE_MM[row] + off_mm.get(row, 0.0)) * PER_MM).to_bytes(
                4, "little", signed=True
            ),
        )
        for row in rows
    ]


def touched(
    value_mm: float,
    off_mm: dict[int, float] | None = None,
    *,
    source: str = "PLC",
    period_ms: int = 1,
    rows: range = range(ROWS),
    **more: Any,
) -> Left:
    """A run from 25 to 40 ms whose probe switches at 30 ms, at a terminal of the PLC."""
    record = replace(run(25, 40, value_mm), sources={"Z": source})
    made = left(
        "source-plc",
        TRUE_MM,
        runs=(record,),
        probes={"probe": ProbeRecord(True, 0.0, edges=(Edge(30 * MS + 7, True),))},
        plc_task=PlcTaskRecord(period_ms * MS, 0, 0, period_ms * MS, 0, probes=("probe",)),
        **more,
    )
    sent = Received({"Z": positions(off_mm or {}, rows)}, {"Z": INCREMENTS})
    return replace(made, received=sent)


def observed(made: Left) -> Observed:
    return Observed(made.facts, made.series).until_run(0)


def at(made: Left, at_us: float) -> float | None:
    assert made.received is not None
    return _at(observed(made), made.received, "Z", round(at_us * US))


# Positions that have come


@pytest.mark.parametrize("sign", [1, -1])
def test_a_position_at_a_sync_is_what_its_telegram_brought(sign: int) -> None:
    """Of the first and of the last one too, that have none beside them."""
    off_mm = {0: sign * 0.03, 50: sign * 0.01, 39: sign * 0.02}
    made = touched(0.0, off_mm)
    for row, off in off_mm.items():
        assert at(made, row * 1000) == pytest.approx(TRUE_MM[row] + off, abs=1e-9)
    assert at(made, 51_000) == pytest.approx(TRUE_MM[51], abs=1e-9)
    assert at(made, 99_000) == pytest.approx(TRUE_MM[99], abs=1e-9)


@pytest.mark.parametrize(
    ("at_us", "is_known"),
    [(500, False), (999, False), (1001, True), (1500, True), (97_999, True), (98_001, False),
     (98_500, False), (0, True), (1000, True)],
)  # fmt: skip
def test_between_syncs_there_have_to_be_two_on_either_side(at_us: int, is_known: bool) -> None:
    """Rows 0 to 99: a cubic from row 0 to 3 is for what lies between 1 and 2."""
    value_mm = at(touched(0.0), at_us)
    if is_known:
        assert value_mm == pytest.approx(20e-3 * at_us * 1e-3, abs=1e-5)
    else:
        assert value_mm is None


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("row", "weight"), [(29, -1 / 16), (30, 9 / 16), (31, 9 / 16),
                                             (32, -1 / 16), (28, 0.0), (33, 0.0)])  # fmt: skip
def test_half_way_between_two_positions_each_has_its_weight(
    sign: int, row: int, weight: float
) -> None:
    """A cubic in the midst of four: -1/16, 9/16, 9/16, -1/16."""
    made = touched(0.0, {row: sign * 0.16})
    assert at(made, 30_500) == pytest.approx(0.61 + sign * 0.16 * weight, abs=1e-5)


def test_of_an_axis_that_no_wire_shows_the_positions_are_true() -> None:
    """As on EtherCAT: whatever has come of another axis."""
    made = touched(0.0)
    made = replace(made, received=Received({"X": positions({30: 1.0})}, {"X": INCREMENTS}))
    assert at(made, 30_000) == pytest.approx(TRUE_MM[30], abs=1e-12)
    assert at(made, 30_500) == pytest.approx(0.61, abs=1e-9)


# Levels of a node


def levels(*changes_ms: int, is_on: bool = False) -> list[Telegram]:
    """A telegram a millisecond, whose level changes at some."""
    sent = []
    for row in range(ROWS):
        if row in changes_ms:
            is_on = not is_on
        sent.append((row * MS + 200 * US, bytes([is_on])))
    return sent


def predicted(made: Left, inputs: Sequence[Telegram]) -> list[float]:
    assert made.received is not None
    run_of_z = touch(observed(made), "Z")
    assert run_of_z is not None
    sent = replace(made.received, inputs=list(inputs))
    return list(predicted_mm(observed(made), sent, run_of_z, "Z"))


@pytest.mark.parametrize(
    ("inputs", "row"),
    [
        (levels(30), 31),  # at 30.2 ms: the PLC at 31 ms, the CNC at 31.6 ms
        (levels(34), 35),
        (levels(25), 26),
        (levels(28, 30, is_on=True), 31),  # it opens first
        (levels(28, 30, 33), 29),  # the first of two
        (levels(19), None),  # before the run
        (levels(24), 25),  # after its begin
        (levels(41), None),  # after it
        (levels(60, 70), None),
        (levels(), None),
        (levels(is_on=True), None),
        (levels(30, is_on=True), None),  # it opens alone
        (levels(10, 19, is_on=True), None),
    ],
)
def test_a_level_of_a_node_counts_within_its_run(inputs: list[Telegram], row: int | None) -> None:
    """Whatever the probe did: what a node has sent is what the PLC has."""
    want = [] if row is None else [pytest.approx(TRUE_MM[row], abs=1e-9)]
    assert predicted(touched(0.0), inputs) == want


@pytest.mark.parametrize(
    ("inputs", "row"),
    [
        (levels(29), 32),  # a PLC each 4 ms: at 32 ms
        (levels(29, 31), None),  # closed and open again between two of its cycles
        (levels(29, 31, 34), 36),  # .. and closed once more
        (levels(29, 31, 34, 39), 36),
        (levels(28, 33), 32),
    ],
)
def test_a_level_that_is_over_before_the_plc_looks_is_none(
    inputs: list[Telegram], row: int | None
) -> None:
    want = [] if row is None else [pytest.approx(TRUE_MM[row], abs=1e-9)]
    assert predicted(touched(0.0, period_ms=4), inputs) == want


def test_falling_edges_are_looked_for_where_the_list_asks_for_them() -> None:
    lists = {**LISTS, "kenngr.measure.edge": "NEG"}
    made = touched(0.0, lists=lists)
    assert predicted(made, levels(30, is_on=True)) == [pytest.approx(TRUE_MM[31], abs=1e-9)]
    assert predicted(made, levels(30)) == []
    assert predicted(made, levels(28, 33)) == [pytest.approx(TRUE_MM[34], abs=1e-9)]


# Who is excused


def beside(made: Left, axis: str, *, is_first: bool) -> Left:
    """The recording with a second axis, before or after Z."""
    other = {axis: made.facts.axes["Z"]}
    axes = {**other, **made.facts.axes} if is_first else {**made.facts.axes, **other}
    return replace(made, facts=replace(made.facts, axes=axes))


@pytest.mark.parametrize("is_first", [True, False])
def test_a_value_is_excused_by_what_was_brought_of_its_own_axis(is_first: bool) -> None:
    wrong_mm = TRUE_MM[31] + OFF_MM
    made = beside(touched(wrong_mm, {31: OFF_MM}), "X", is_first=is_first)
    assert judge(made).result is Result.UNKNOWABLE
    assert judge(beside(touched(wrong_mm), "X", is_first=is_first)).result is Result.BROKEN


@pytest.mark.parametrize(
    ("source", "excused"),
    [("PLC", True), ("PLC_FIRST_EVENT", True), ("DRIVE", False), ("EXT_PROBE_WITH_DRIVE", False)],
)
def test_no_value_that_a_drive_has_stored_is_excused(source: str, excused: bool) -> None:
    """It proves its latch beside the cycle: what a telegram brought has no part in it."""
    wrong_mm = TRUE_MM[31] + OFF_MM
    made = touched(wrong_mm, {31: OFF_MM}, source=source, edges=(edge(31, TRUE_MM[31]),))
    assert is_unknowable(made, 0, "Z") is excused


# Distance control


GOES_MM = [min(row, 50) * 90e-3 for row in range(100)]
"""90 mm/s until row 50, then it stands at once."""
FROZEN = [4.0] * 49 + [2.0] * 51


@pytest.mark.parametrize(
    ("own", "whole", "wrong"),
    [
        (FROZEN, FROZEN, []),
        (FROZEN, [4.0] * 100, []),
        ([4.0] * 100, [4.0] * 100, ["acceleration"]),
    ],
)
def test_what_two_controls_superpose_may_stop_at_once(
    own: list[float], whole: list[float], wrong: list[str]
) -> None:
    """50 mm/s each: together they lose 90 mm/s; of one alone that would be too much."""
    lists = {**LISTS, "kenngr.dist_ctrl[0].v_max": 50_000, "kenngr.dist_ctrl[0].a_max": 1000}
    of_channel = {"v_max": 50_000, "a_max": 1000}
    columns = {"Z.distance_state": own, "channel.distance_state": whole}
    made = left(
        "distance", GOES_MM, lists, columns=columns, control=("INACTIVE", "ACTIVE"),
        channel_lists=of_channel,
    )  # fmt: skip
    assert found(made) == wrong
    alone = left("distance", GOES_MM, lists, columns={"Z.distance_state": own},
                 control=("INACTIVE", "ACTIVE"))  # fmt: skip
    assert found(alone) == ["acceleration"]


@pytest.mark.parametrize(
    ("held", "wrong"),
    [
        ([0.0] * 49 + [1.0] * 51, []),
        ([1.0] * 49 + [0.0] * 51, ["acceleration"]),
        ([0.0] * 100, ["acceleration"]),
        ([1.0] * 100, ["acceleration"]),
    ],
)
def test_an_offset_may_stop_where_it_is_held_and_not_where_it_is_let_go(
    held: list[float], wrong: list[str]
) -> None:
    course_mm = [min(row, 50) * 9e-3 for row in range(100)]
    lists = {**LISTS, "kenngr.dist_ctrl[0].v_max": 50_000, "kenngr.dist_ctrl[0].a_max": 1000}
    columns = {"Z.distance_state": [4.0] * 100, "Z.distance_held": held}
    made = left("distance", course_mm, lists, columns=columns, control=("INACTIVE", "ACTIVE"))
    assert found(made) == wrong


@pytest.mark.parametrize(
    ("last", "at_ms", "wrong"),
    [("ACTIVE", 99, ["states"]), ("ACTIVE", 50, ["states"]), ("INACTIVE", 99, [])],
)  # fmt: skip
def test_a_state_as_the_program_ends_has_its_edge_too(
    last: str, at_ms: int, wrong: list[str]
) -> None:
    """Only INACTIVE is left then without one."""
    record = DistanceRecord(
        changes=tuple(
            DistanceChange(ms * MS, name, "NC", "gap", False, CONTROLLER)
            for name, ms in (("INACTIVE", 1), ("ERROR", 5), (last, at_ms))
        )
    )
    made = left()
    made = replace(made, facts=replace(made.facts, distance={"Z": record}))
    assert found(made) == wrong


# Set positions


@pytest.mark.parametrize("sign", [1, -1])
def test_an_axis_that_is_not_programmed_may_not_move_and_come_back(sign: int) -> None:
    away = [1.0] * 50 + [1.0 + sign * STEP_MM] * 10 + [1.0] * 40
    made = left("three-axes", away, axis="X", lists={})
    assert found(replace(made, machine=replace(made.machine, still=("X",)))) == ["still"]
    assert found(replace(made, machine=replace(made.machine, still=()))) == []


@pytest.mark.parametrize(("channel", "wrong"), [({}, []), ({"messtyp": 4}, ["stroke"]),
                                                ({"messtyp": 1}, [])])  # fmt: skip
def test_only_a_run_of_type_4_has_a_stroke(channel: dict[str, int], wrong: list[str]) -> None:
    """2 mm behind the signal, 1 mm allowed; what a list does not write is type 1 (P-CHAN-00057)."""
    z_mm = [0.0] * 30 + [0.02 * min(n, 100) for n in range(70)]
    runs = (replace(run(25, 99, None), signal_ns=30 * MS),)
    made = left("overrides", z_mm, {"kenngr.hub_messtaster": 10_000}, runs=runs)
    assert found(replace(made, facts=replace(made.facts, channel=channel))) == wrong


def test_a_judgement_says_of_each_invariant_what_is_wrong() -> None:
    """150 mm/s at 100 allowed, with 5000 mm/s2 at 4000."""
    speeds = [min(150.0, 5.0 * row) for row in range(ROWS)]
    z_mm = [sum(speeds[: row + 1]) * 1e-3 for row in range(ROWS)]
    made = judge(left(set_mm=z_mm))
    assert made.broken == ("speed", "acceleration")
    speed, acceleration = made.note.split("; ")
    assert speed.startswith("speed: axis Z: speed 150 mm/s")
    assert acceleration.startswith("acceleration: axis Z: acceleration 5000 mm/s2")


# Drawing and taking away


def test_a_file_of_a_machine_is_beside_its_table_or_of_the_shipped_plans(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """None that happens to be where the command runs."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.toml").touch()
    (tmp_path / "testplans").mkdir()
    (tmp_path / "testplans" / "own.toml").touch()
    assert path_of("testplans/own.toml") == Path("testplans/own.toml")
    assert path_of("probe.toml").is_absolute()
    for text in ("own.toml", "testplans/other.toml"):
        with pytest.raises(UserError, match="is not there"):
            path_of(text)


def test_words_of_a_place_have_no_blanks() -> None:
    drawn = {draw_inputs("a={ x |y|  z w }", random.Random(seed))[0] for seed in range(60)}
    assert drawn == {"a=x", "a=y", "a=z w"}


def scenario(*assignments: str) -> Scenario:
    return Scenario(1, 2, assignments)


def test_faults_are_columns_of_faults_and_stay_in_their_order() -> None:
    """A value that is called like one is none; kinds stay as they came first."""
    made = scenario(
        "plc:V.E.TEXT=fault:drop", "fault:stick=a at=1ms; b", "fault:drop=c", "x=fault:"
    )
    assert made.faults == ("fault:stick=a at=1ms; b", "fault:drop=c")
    assert faults_of(made) == [("stick", "a at=1ms"), ("stick", "b"), ("drop", "c")]
    again = _with(made, [("stick", "b"), ("drop", "c"), ("stick", "d")])
    assert again.assignments == (
        "plc:V.E.TEXT=fault:drop", "x=fault:", "fault:stick=b; d", "fault:drop=c"
    )  # fmt: skip
    assert _with(made, []).assignments == ("plc:V.E.TEXT=fault:drop", "x=fault:")
