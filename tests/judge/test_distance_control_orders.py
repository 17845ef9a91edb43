"""What was asked of a distance control, by rows: with orders, and from changes of older recordings.

Rows are SYNCs each 2 ms, the cycle of one begins at it.
"""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.judge.distance.orders import orders_of, row_of, set_by_program
from axisrig.bench.oracles.distance.acting import Order
from axisrig.bench.record.distance import (
    Controller,
    DistanceChange,
    DistanceOrder,
    DistanceRecord,
)
from axisrig.kernel.time.clock import MS, US

OBSERVED: Any = SimpleNamespace(
    facts=SimpleNamespace(timing=SimpleNamespace(period_ns=2 * MS)),
    index_at=lambda time_ns: time_ns // (2 * MS),
)
CONTROLLER = Controller(0.2, 5.0, 0.01, "NONE", 1, 0.5, 1, 10.0, 0.05, False)


def test_an_instant_belongs_to_the_row_of_its_cycle() -> None:
    for time_ns, row in ((0, 0), (600 * US, 0), (2 * MS - 1, 0), (2 * MS, 1), (7 * MS, 3)):
        assert row_of(OBSERVED, time_ns) == row


@pytest.mark.parametrize("late_ns", [0, 48 * US, 2 * MS - 1])
def test_a_sync_that_comes_late_in_its_cycle_has_the_orders_of_the_whole_cycle(
    late_ns: int,
) -> None:
    """Those before the SYNC too: they were given in the cycle that it belongs to."""
    observed: Any = SimpleNamespace(
        facts=OBSERVED.facts, index_at=lambda time_ns: max((time_ns - late_ns) // (2 * MS), 0)
    )
    for time_ns, row in ((0, 0), (2 * MS - 1, 0), (2 * MS, 1), (4 * MS - 1, 1), (4 * MS, 2)):
        assert row_of(observed, time_ns) == row


def test_orders_have_the_row_of_their_cycle_and_their_words() -> None:
    asked = (
        DistanceOrder(4 * MS, "PLC", "ON", is_dry_run=True, words={"kp": 0.3}),
        DistanceOrder(5 * MS, "OBJECT", words={"i_tn": 2.0}),
    )
    assert orders_of(OBSERVED, DistanceRecord(orders=asked)) == [
        Order(2, "PLC", "ON", True, {"kp": 0.3}), Order(2, "OBJECT", "", False, {"i_tn": 2.0}),
    ]  # fmt: skip
    assert orders_of(OBSERVED, DistanceRecord(orders=())) == []


WORDS = [
    ("kp", {"kp": 0.4}, 0.4),
    ("i_tn", {"tn_s": 7.0}, 7.0),
    ("d_tv", {"tv_s": 0.5}, 0.5),
    ("filter_type", {"filter_type": "KALMAN"}, "KALMAN"),
    ("n_cycles", {"count": 20}, 20),
    ("smoothing_factor", {"alpha": 0.25}, 0.25),
    ("low_pass_filter_order", {"order": 3}, 3),
    ("low_pass_filter_fg_f0", {"corner_hz": 40.0}, 40.0),
    ("kalman_sigma", {"sigma_mm": 0.2}, 2000.0),  # 0.1 um
    ("mode_dist_use_both_encoder", {"both_encoders": True}, True),
]


@pytest.mark.parametrize(("word", "change", "value"), WORDS)
def test_of_an_older_recording_what_has_changed_was_asked(
    word: str, change: dict[str, Any], value: object
) -> None:
    """Version 3 and before: changes alone. What did not change is no word."""
    other = replace(CONTROLLER, **change)
    changes = (
        DistanceChange(0, "INACTIVE", "NC", "60E4", False, CONTROLLER),
        DistanceChange(4 * MS, "ACTIVE", "PLC", "60E4", False, CONTROLLER),
        DistanceChange(6 * MS, "ACTIVE", "PLC", "60E4", False, other),
        DistanceChange(8 * MS, "FREEZE", "PLC", "60E4", False, other),
        DistanceChange(10 * MS, "ACTIVE_CONST_DIST", "NC", "60E4", False, other),
        DistanceChange(12 * MS, "ACTIVE_CONST_DIST", "PLC", "60E4", True, other),
        DistanceChange(14 * MS, "INACTIVE", "PLC", "60E4", True, CONTROLLER),
    )
    found = orders_of(OBSERVED, DistanceRecord(changes=changes, orders=None))
    before = {"kp": 0.2, "i_tn": 5.0, "d_tv": 0.01, "filter_type": "NONE", "n_cycles": 1,
              "smoothing_factor": 0.5, "low_pass_filter_order": 1, "low_pass_filter_fg_f0": 10.0,
              "kalman_sigma": 500.0, "mode_dist_use_both_encoder": False}  # fmt: skip
    assert found == [
        Order(0, "NC", "OFF", False, {}),
        Order(2, "PLC", "ON", False, {}),
        Order(3, "NC", "", False, {word: value}),  # the state is as before: a word of the program
        Order(4, "PLC", "FREEZE", False, {}),
        Order(5, "NC", "ON_CONST_DIST", False, {}),
        Order(6, "PLC", "ON_CONST_DIST", True, {}),
        Order(7, "PLC", "OFF", True, {word: before[word]}),
    ]
    assert orders_of(OBSERVED, DistanceRecord(orders=None)) == []


def test_set_values_of_the_program_have_those_of_the_plc_of_their_cycle() -> None:
    asked = (
        DistanceOrder(2 * MS, "PLC", set_pos_mm=1.0),
        DistanceOrder(2 * MS, "NC", set_pos_mm=2.0, set_dist_mm=3.0),
        DistanceOrder(4 * MS, "NC", "ON"),
        DistanceOrder(6 * MS, "PLC", set_dist_mm=0.0),
        DistanceOrder(7 * MS, "NC", set_dist_mm=5.0),
        DistanceOrder(8 * MS, "NC", set_dist_mm=0.0),
        DistanceOrder(10 * MS, "PLC", set_pos_mm=6.0),
    )
    assert set_by_program(OBSERVED, DistanceRecord(orders=asked)) == {
        "set_pos_mm": {1: 1.0}, "set_dist_mm": {1: None, 3: 0.0, 4: None},
    }  # fmt: skip
    assert set_by_program(OBSERVED, DistanceRecord(orders=None)) == {
        "set_pos_mm": {}, "set_dist_mm": {},
    }  # fmt: skip


@pytest.mark.parametrize("column", ["set_pos_mm", "set_dist_mm"])
@pytest.mark.parametrize("given", [(1.0, 2.5), (2.5, 1.0), (0.0, -1.0, 0.0)])
def test_of_several_values_of_the_plc_in_a_cycle_the_last_one_is_beside_the_program(
    column: str, given: tuple[float, ...]
) -> None:
    """Another cycle has its own, and the other column has none."""
    asked = (
        *(DistanceOrder(4 * MS + k, "PLC", **{column: mm}) for k, mm in enumerate(given)),
        DistanceOrder(4 * MS + 9, "NC", **{column: 7.0}),
        DistanceOrder(6 * MS, "NC", **{column: 8.0}),
    )
    found = set_by_program(OBSERVED, DistanceRecord(orders=asked))
    other = {"set_pos_mm", "set_dist_mm"} - {column}
    assert found == {column: {2: given[-1], 3: None}, **{name: {} for name in other}}
