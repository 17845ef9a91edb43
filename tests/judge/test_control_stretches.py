"""Unbroken times of distance control: what divides them, and what a steady part must be without."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.judge.controls import ON, WITH_CONST_DIST, K, recorded, truth_of_steps

from axisrig.bench.judge.distance.control_stretches import (
    Stretch,
    _by_law,
    is_disturbed,
    last_on,
    steady,
)
from axisrig.bench.judge.distance.times import Unbroken
from axisrig.bench.judge.distance.tool import distance_truth
from axisrig.bench.judge.distance.truth import ACTIVE, ACTIVE_CONST_DIST, INACTIVE
from axisrig.bench.oracles.distance.acting import Acting
from axisrig.bench.record.distance import DistanceOrder
from axisrig.kernel.time.clock import MS

ONE, OTHER = "a list", "another list"


def divided(*acting: tuple[int, str, bool, bool]) -> list[tuple[int, int, object, bool]]:
    """Rows 10 to 50 of a control that follows; acting: row, list, dry run, begins."""
    laws: Any = [Acting(row, listed, dry, begins) for row, listed, dry, begins in acting]  # type: ignore[arg-type]
    truth: Any = SimpleNamespace(
        acting=laws,
        acting_in=lambda row: [law for law in laws if law.row <= row][-1],
        mode_in=lambda _state, _listed: "SET_POS",
    )
    found = _by_law(truth, Unbroken(10, 50, ACTIVE))
    return [(one.begin, one.end, one.listed, one.is_dry_run) for one in found]


@pytest.mark.parametrize(
    ("law", "parts"),
    [
        ((30, ONE, False, False), [(10, 50, ONE, False)]),
        ((30, OTHER, False, False), [(10, 30, ONE, False), (30, 50, OTHER, False)]),
        ((30, ONE, True, False), [(10, 30, ONE, False), (30, 50, ONE, True)]),
        ((30, ONE, False, True), [(10, 30, ONE, False), (30, 50, ONE, False)]),
        ((11, OTHER, False, False), [(10, 50, OTHER, False)]),  # it has begun with it
        ((50, OTHER, True, True), [(10, 50, ONE, False)]),
    ],
)
def test_a_law_ends_where_list_dry_run_or_switching_on_make_another(
    law: tuple[int, str, bool, bool], parts: list[tuple[int, int, object, bool]]
) -> None:
    assert divided((10, ONE, False, True), law) == parts


def test_a_dry_run_that_ends_and_comes_again_are_four_parts() -> None:
    laws = [(row, ONE, dry, False) for row, dry in ((20, True), (30, False), (40, True))]
    parts = divided((10, ONE, False, True), *laws)
    assert [(begin, end, dry) for begin, end, _, dry in parts] == [
        *((10, 20, False), (20, 30, True), (30, 40, False), (40, 50, True)),
    ]


@pytest.mark.parametrize("mode", ["SET_POS", "CONST_DIST"])
def test_a_part_is_disturbed_by_its_own_set_value_and_by_a_hold(mode: str) -> None:
    """Of the set value of the other mode nothing depends; the first change is the begin."""
    own, other = (
        ("set_pos_mm", "set_dist_mm") if mode == "SET_POS" else ("set_dist_mm", "set_pos_mm")
    )
    columns = {
        own: np.array([0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0]),
        other: np.array([0.0, 9.0, 8.0, 7.0, 6.0, 5.0, 4.0, 3.0]),
        "distance_held": np.array([0, 0, 0, 0, 0, 0, 1, 0]),
    }

    class Part(dict[str, Any]):
        def wanted_mm(self, name: str) -> Any:
            return self[name]

    truth: Any = SimpleNamespace(gathered=lambda made, rows: made(Part(columns))[rows])
    part = Stretch(0, 8, mode, None)  # type: ignore[arg-type]
    assert is_disturbed(truth, part).tolist() == [
        *(False, False, False, True, False, True, False),
    ]


@pytest.mark.parametrize("row", range(1, 6))
@pytest.mark.parametrize("mode", ["SET_POS", "CONST_DIST"])
def test_every_change_of_a_set_value_but_that_of_the_begin_disturbs(mode: str, row: int) -> None:
    """What changes with the first step of a part, the part has begun with."""

    class Part:
        def wanted_mm(self, _column: str) -> Any:
            return np.where(np.arange(6) >= row, 1.0, 0.0)

        def __getitem__(self, _column: str) -> Any:
            return np.zeros(6)

    truth: Any = SimpleNamespace(gathered=lambda made, rows: made(Part())[rows])
    found = is_disturbed(truth, Stretch(0, 6, mode, None)).tolist()  # type: ignore[arg-type]
    assert found == [row > 1 and place == row - 1 for place in range(5)]


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("turn", [1, -1])
def test_a_steady_part_is_where_the_surface_moves_up_or_down_however_long_it_rests(
    sign: int, turn: int
) -> None:
    """Rest for 60 cycles, 0.01 mm in each of 30 after or before it: the shorter part counts."""
    steps_mm = np.concatenate([np.zeros(60), np.full(30, sign * 0.01)])[::turn]
    part, speed_mm_s = steady(truth_of_steps(steps_mm))
    assert speed_mm_s == pytest.approx(sign * 10.0)
    assert 28 <= part.end - part.begin <= 30


@pytest.mark.parametrize(
    ("orders", "rows"),
    [
        ([], [(100, 1000)]),
        ([(300, 0.3)], [(100, 301), (301, 1000)]),
        ([(300, 0.3), (500, 0.4), (700, 0.3)], [(100, 301), (301, 501), (501, 701), (701, 1000)]),
    ],
)
def test_the_last_time_with_the_control_on_has_its_laws_in_their_order(
    orders: list[tuple[int, float]], rows: list[tuple[int, int]]
) -> None:
    """kp is given by the program, so that it acts a row later; a time before is another one."""
    words = tuple(DistanceOrder(row * MS, "NC", words={"kp": kp}) for row, kp in orders)
    truth = distance_truth(recorded(orders=(WITH_CONST_DIST, *words)), "Z")
    assert truth is not None
    found = last_on(truth)
    assert [(one.begin, one.end) for one in found] == rows
    assert [one.kp for one in found] == [0.2, *(kp for _, kp in orders)]
    state = np.where((K < ON) | ((K >= 600) & (K < 650)), INACTIVE, ACTIVE_CONST_DIST)
    apart = distance_truth(
        recorded(orders=(WITH_CONST_DIST,), columns={"distance_state": state.astype(float)}), "Z"
    )
    assert apart is not None
    assert [(one.begin, one.end) for one in last_on(apart)] == [(650, 1000)]


@pytest.mark.parametrize("optimized", [0, 1])
def test_the_program_is_where_the_set_position_is_without_the_offset(optimized: int) -> None:
    """Sent in the same cycle with optimized scheduling, else in the one after it."""
    offset = np.where(K >= 400, 0.5, 0.0) + np.where(K >= 700, 0.25, 0.0)
    sent = offset if optimized else np.concatenate([offset[:1], offset[:-1]])
    columns = {"offset_mm": offset, "set_mm": 7.0 + 0.001 * K + sent}
    observed = recorded(columns=columns, words={"optimized_scheduling": optimized})
    truth = distance_truth(observed, "Z")
    assert truth is not None
    assert truth.program_mm == pytest.approx(7.0 + 0.001 * K)
