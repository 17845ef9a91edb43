"""Invariants where there are two of a kind: runs, edges, inputs, axes, alarms; and their bounds.

Recordings made by hand, a row each millisecond, limits in round numbers.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest
from tests.faults.made_runs import (
    BRAKES,
    LISTS,
    STEP_MM,
    alarm,
    braked,
    edge,
    found,
    left,
    ramp,
    run,
)

from axisrig.bench.record.facts import MessageRecord
from axisrig.bench.record.measuring import FixedStop
from axisrig.bench.tools.scenarios.invariants import ending, invariants, values_of
from axisrig.bench.tools.scenarios.left import Left
from axisrig.bench.tools.scenarios.machines import machines
from axisrig.bench.tools.scenarios.oracle import Result, judge
from axisrig.kernel.time.clock import MS


def of_axis(made: Left, **changed: Any) -> Left:
    """The recording with another record of Z."""
    axes = {**made.facts.axes, "Z": replace(made.facts.axes["Z"], **changed)}
    return replace(made, facts=replace(made.facts, axes=axes))


def test_every_but_leaves_out_all_that_it_names() -> None:
    about = {each.name: set(each.machines) for each in invariants()}
    assert about["rest"] == set(machines())
    assert about["speed"] == set(machines()) - {"homing"}
    assert about["still"] < about["rest"]
    assert {"three-axes", "ethercat-axes"} <= about["still"]
    assert "every" not in {name for each in about.values() for name in each}


TWICE = (edge(30, 10.0), edge(35, 12.0), edge(50, 20.0))


def one_value(value_mm: float | None, **more: Any) -> Left:
    return left(**{"runs": (run(25, 40, value_mm),), "edges": TWICE, **more})


def begun(value_mm: float) -> Left:
    """A run that came to no start: it has begun at 20 ms."""
    return one_value(value_mm, runs=(replace(run(25, 40, value_mm), start_ns=None),))


def printed_while_open(value_mm: float) -> Left:
    """A program that prints within a run that never ends."""
    open_run = replace(run(25, 40, None), end_ns=None)
    message = MessageRecord(machines()["one-axis"].prints[0], (value_mm,), "")
    return left(runs=(open_run,), edges=(edge(90, 10.0),), messages=(message,))


def homed(value_mm: float, origin_mm: float = 3.0) -> Left:
    """G74 before the run: the drive counts from 3 mm of the plant."""
    return of_axis(one_value(value_mm), homed_ns=(5 * MS,), origin_mm=origin_mm)


def second_input(value_mm: float) -> Left:
    """The run watches input 2, whose probe is another one than that of input 1."""
    other = replace(edge(32, 11.0), probe="other")
    made = one_value(value_mm, edges=(*TWICE, other))
    made = of_axis(made, signals={"probe_1": "probe", "probe_2": "other"})
    runs = tuple(replace(each, inputs={"Z": 2}) for each in made.facts.runs)
    return replace(made, facts=replace(made.facts, runs=runs))


def without_edge_in_list(value_mm: float) -> Left:
    """P-AXIS-00518 is not written: POS (docs/parameters.md)."""
    lists = {name: each for name, each in LISTS.items() if "edge" not in name}
    return one_value(value_mm, lists=lists, edges=(edge(29, 5.0, level=False), *TWICE))


def falling(value_mm: float) -> Left:
    lists = {**LISTS, "kenngr.measure.edge": "NEG"}
    return one_value(value_mm, lists=lists, edges=(*TWICE, edge(33, 11.5, level=False)))


@pytest.mark.parametrize(
    ("holds", "breaks"),
    [
        (one_value(10.0), one_value(12.0)),  # the first of two edges
        (begun(10.0), one_value(10.0, runs=(replace(run(36, 40, 10.0), start_ns=None),))),
        (printed_while_open(10.0), printed_while_open(20.0)),
        (homed(7.0), homed(10.0)),
        (second_input(11.0), second_input(10.0)),
        (without_edge_in_list(10.0), without_edge_in_list(5.0)),
        (falling(11.5), falling(10.0)),
        (one_value(10.0 - 0.99 * STEP_MM), one_value(10.0 - 1.01 * STEP_MM)),
    ],
    ids=["first", "begun", "open", "homed", "input", "no word", "falling", "below"],
)
def test_a_value_is_that_of_its_edge(holds: Left, breaks: Left) -> None:
    assert found(holds) == []
    assert found(breaks) == ["value"]


def test_between_begin_and_no_start_the_begin_counts() -> None:
    """The run has begun at 20 ms: an edge there counts, one before it does not."""
    for at_ms, wrong in ((20, []), (19, ["value"])):
        runs = (replace(run(25, 40, 10.0), start_ns=None),)
        assert found(one_value(10.0, edges=(edge(at_ms, 10.0),), runs=runs)) == wrong


def test_a_run_that_has_not_ended_has_published_nothing() -> None:
    made = one_value(99.0, runs=(replace(run(25, 40, 99.0), end_ns=None),))
    assert list(values_of(made)) == []
    assert found(made) == []


def test_what_cannot_be_decided_is_not_broken() -> None:
    assert found(one_value(99.0)) == ["value"]
    hidden = one_value(99.0, hidden=("value",))
    assert found(hidden) == []
    assert judge(hidden).result is Result.GOOD


def test_a_further_alarm_ends_nothing_and_counts_for_nothing() -> None:
    first = replace(alarm(10, number=7), is_further=True)
    made = left(set_mm=braked(2000.0), lists=BRAKES, alarms=(first, alarm(30, number=8)))
    last = ending(made)
    assert last is not None
    assert last.id == 8
    assert found(made) == []
    judgement = judge(made)
    assert (judgement.alarms, judgement.result) == ([8], Result.ALARM)


@pytest.mark.parametrize("is_broken", [False, True])
def test_a_judgement_has_the_hash_of_its_frames(is_broken: bool) -> None:
    made = one_value(99.0 if is_broken else 10.0)
    made = replace(made, facts=replace(made.facts, frame_log_sha256="abc"))
    judgement = judge(made)
    assert judgement.frames == "abc"
    assert (judgement.result is Result.BROKEN) is is_broken


def at_stop(forces_n: Sequence[float]) -> Left:
    """The stop is found at 35 ms, the run ends at 40 ms."""
    stop = FixedStop({}, detected_ns=35 * MS)
    runs = (run(25, 40, 10.0, fixed_stop=stop),)
    return left("fixed-stop", runs=runs, columns={"Z.stop_force_n": forces_n})


@pytest.mark.parametrize(
    ("forces_n", "wrong"),
    [
        ([0.0] * 35 + [9.0] * 65, []),
        ([0.0] * 35 + [-9.0] * 65, []),  # towards smaller positions
        ([0.0] * 36 + [9.0] * 64, ["found-stop"]),  # only afterwards
        ([9.0] * 35 + [0.0] * 65, ["found-stop"]),  # not any more
    ],
)
def test_the_stop_pushes_when_it_is_found(forces_n: list[float], wrong: list[str]) -> None:
    assert found(at_stop(forces_n)) == wrong


# Limits of set positions: an increment of rounding in each of the positions that are compared


@pytest.mark.parametrize(("a_mm_s2", "wrong"), [(4015.0, []), (4025.0, ["acceleration"])])
def test_the_second_difference_has_two_increments_of_rounding(
    a_mm_s2: float, wrong: list[str]
) -> None:
    """0.01 um in 1 ms twice: 20 mm/s2 on top of 4000."""
    assert found(left(set_mm=ramp(50.0, a_mm_s2))) == wrong


def two_axes(
    z_mm: Sequence[float], x_mm: Sequence[float], z_lists: Any = LISTS, **more: Any
) -> Left:
    """Z and an X with the lists of every axis here."""
    made = left("gantry", z_mm, z_lists, columns={"X.set_mm": x_mm}, **more)
    axes = {**made.facts.axes, "X": replace(made.facts.axes["Z"], written=dict(LISTS))}
    return replace(made, facts=replace(made.facts, axes=axes))


STILL_MM = [1.0] * 100


def test_an_axis_without_a_limit_in_its_list_hides_no_other_one() -> None:
    fast = ramp(150.0, 4000.0)
    assert found(two_axes(fast, STILL_MM, {})) == []
    assert found(two_axes(STILL_MM, fast, {})) == ["speed"]


def test_going_back_is_as_fast_as_going_on() -> None:
    back = [-place for place in ramp(150.0, 4000.0)]
    assert found(left(set_mm=back)) == ["speed"]
    assert found(left(set_mm=[-place for place in ramp(50.0, 4100.0)])) == ["acceleration"]


@pytest.mark.parametrize("axis", ["X", "Y"])
def test_every_axis_that_is_not_programmed_stays(axis: str) -> None:
    made = left("three-axes", [1.0] * 99 + [1.0 + STEP_MM], axis=axis, lists={})
    made = replace(made, machine=replace(made.machine, still=("X", "Y")))
    assert found(made) == ["still"]


def stroked(*ways_mm: float, after_mm: float = 0.0, back: bool = False) -> Left:
    """Runs of type 4 of Z, 30 ms long each with a signal in the middle; an axis X runs with it.

    ways_mm: of Z after the signal of each run; None in a run without one. after_mm: beyond the end
    of the last run. back: the way is undone before the run ends.
    """
    z_mm: list[float] = [0.0]
    for way_mm in ways_mm:
        part = [way_mm * min(n / 14, 1.0) for n in range(1, 16)]
        if back:
            part = [way_mm * min(n, 14 - n) / 7 for n in range(15)]
        z_mm += [z_mm[-1]] * 15 + [z_mm[-1] + each for each in part]
    rest = 100 - len(z_mm)
    z_mm += [z_mm[-1] + after_mm * min(n / 8, 1.0) for n in range(rest)]
    lists = {"kenngr.hub_messtaster": 10_000}
    runs = tuple(
        replace(run(30 * n + 5, 30 * n + 30, None), signal_ns=(30 * n + 15) * MS)
        for n in range(len(ways_mm))
    )
    made = left("overrides", z_mm, lists, runs=runs)
    return replace(made, facts=replace(made.facts, channel={"messtyp": 4}))


def test_each_run_of_type_4_has_its_stroke() -> None:
    assert found(stroked(0.99, 0.99)) == []
    assert found(stroked(0.5, 1.01)) == ["stroke"]
    assert found(stroked(1.01, 0.5)) == ["stroke"]


def test_a_run_without_a_signal_hides_no_later_one() -> None:
    made = stroked(0.5, 1.01)
    first, second = made.facts.runs
    runs = (replace(first, signal_ns=None), second)
    assert found(replace(made, facts=replace(made.facts, runs=runs))) == ["stroke"]


def test_the_stroke_ends_with_its_run_and_is_the_farthest_in_it() -> None:
    assert found(stroked(0.99, after_mm=1.0)) == []
    assert found(stroked(1.01, back=True)) == ["stroke"]
    assert found(stroked(-1.01)) == ["stroke"]


def test_the_stroke_is_of_each_axis_of_a_run() -> None:
    made = stroked(1.01)
    axes = {**made.facts.axes, "X": made.facts.axes["Z"]}
    runs = tuple(replace(each, axes=("X", "Z")) for each in made.facts.runs)
    facts = replace(made.facts, axes=axes, runs=runs)
    assert found(replace(made, facts=facts)) == ["stroke"]
