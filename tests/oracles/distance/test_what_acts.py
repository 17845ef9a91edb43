"""What a distance control acts with, from what was asked of it: FCT-M3 7.6, docs/ambiguities.md."""

from collections.abc import Mapping

import pytest

from axisrig.bench.oracles.distance.acting import NC, OBJECT, PLC, Acting, Order, acting
from axisrig.bench.oracles.distance.lists import OF_AXIS, OF_CHANNEL

MS = 1_000_000
LISTED = {"kenngr.distc.kp": 0.2, "kenngr.distc.v_max": 50_000}


def acts(
    *orders: Order,
    on: Mapping[int, bool] | None = None,
    written: Mapping[str, object] = LISTED,
    stems: tuple[str, ...] = OF_AXIS,
) -> list[Acting]:
    """What acts from which row on; on: rows at whose end the control is on, all others not."""
    return acting(written, stems, orders, MS, lambda row: bool((on or {}).get(row)))


def kps(found: list[Acting]) -> list[tuple[int, float]]:
    return [(one.row, one.listed.control.kp) for one in found]


def on(row: int, by: str = NC, *, dry: bool = False) -> Order:
    return Order(row, by, "ON", dry)


def kp(row: int, value: float, by: str = NC) -> Order:
    return Order(row, by, words={"kp": value})


def test_without_a_word_the_list_acts() -> None:
    assert kps(acts()) == [(0, 0.2)]


def test_a_word_of_the_program_acts_from_the_next_cycle_on() -> None:
    assert kps(acts(kp(7, 0.3))) == [(0, 0.2), (8, 0.3)]


def test_a_command_acts_in_the_next_cycle_of_the_plc_side_in_its_own() -> None:
    by_nc, by_plc = acts(on(7)), acts(on(7, PLC))
    assert [(one.row, one.begins) for one in by_nc] == [(0, False), (8, True)]
    assert [(one.row, one.begins) for one in by_plc] == [(0, False), (7, True)]


@pytest.mark.parametrize("by", [NC, PLC])
def test_an_object_waits_until_the_control_is_switched_on(by: str) -> None:
    row = 10 if by == NC else 9
    assert kps(acts(kp(3, 0.4, OBJECT), on(9, by))) == [(0, 0.2), (row, 0.4)]


def test_an_object_that_is_written_while_on_waits_for_the_next_time() -> None:
    orders = (on(2), kp(5, 0.4, OBJECT), on(6), Order(8, NC, "FREEZE"), on(9))
    found = acts(*orders, on={5: True})
    assert kps(found) == [(0, 0.2), (3, 0.2), (7, 0.2), (9, 0.2), (10, 0.4)]
    assert [one.begins for one in found] == [False, True, False, False, True]


def test_an_object_acts_out_of_a_dry_run_and_in_it() -> None:
    orders = (on(2, dry=True), kp(4, 0.4, OBJECT), on(6))
    found = acts(*orders, on={5: True})
    assert [(one.row, one.listed.control.kp, one.is_dry_run) for one in found] == [
        (0, 0.2, False),
        (3, 0.2, True),
        (7, 0.4, False),
    ]
    assert found[-1].begins


def test_a_dry_run_of_what_is_on_begins_nothing() -> None:
    found = acts(on(2), kp(4, 0.4, OBJECT), on(6, dry=True), on={5: True})
    assert (found[-1].is_dry_run, found[-1].begins, found[-1].listed.control.kp) == (
        True, False, 0.2,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("orders", "acting_kp"),
    [
        pytest.param((kp(2, 0.3), kp(3, 0.4, OBJECT)), 0.4, id="the object is later"),
        pytest.param((kp(2, 0.4, OBJECT), kp(3, 0.3)), 0.3, id="the word is later"),
        pytest.param((kp(2, 0.4, OBJECT), kp(3, 0.5, OBJECT)), 0.5, id="two objects"),
        pytest.param((kp(2, 0.3), kp(2, 0.5)), 0.5, id="two words of one cycle"),
    ],
)
def test_the_later_one_counts(orders: tuple[Order, ...], acting_kp: float) -> None:
    assert acts(*orders, on(4))[-1].listed.control.kp == acting_kp


def test_a_word_leaves_the_object_of_another_parameter() -> None:
    tn = Order(2, OBJECT, words={"i_tn": 0.5})
    control = acts(tn, kp(3, 0.3), on(4))[-1].listed.control
    assert (control.kp, control.tn_s) == (0.3, 0.5)


def test_limits_by_objects_are_in_the_units_of_the_list() -> None:
    words = {"v_max": 60_000, "a_max": 700, "max_act_value_change": 8000}
    limits = acts(Order(1, OBJECT, words=words), on(4))[-1].listed.limits
    assert (limits.v_mm_s, limits.a_mm_s2, limits.change_mm_s) == (60.0, 700.0, 8.0)


def test_both_encoders_by_the_program() -> None:
    listed = {"kenngr.distc.mode_dist_use_both_encoder": 1}
    found = acts(Order(1, NC, words={"mode_dist_use_both_encoder": False}), written=listed)
    assert [one.listed.uses_both for one in found] == [True, False]


def test_a_word_wins_over_both_structures_of_the_list() -> None:
    listed = {"kenngr.distc.kp": 0.1, "kenngr.dist_ctrl[0].kp": 0.2}
    assert kps(acts(kp(1, 0.3), written=listed)) == [(0, 0.2), (2, 0.3)]


def test_a_filter_of_the_program_wins_over_the_older_switch_of_the_list() -> None:
    listed = {"kenngr.distc.low_pass_filter_enable": 1}
    found = acts(Order(1, NC, words={"filter_type": "DEFAULT"}), written=listed)
    assert [one.listed.control.filter_type for one in found] == ["LOWPASS", "DEFAULT"]


def test_a_filter_time_of_3d_control_is_a_number_of_cycles() -> None:
    found = acts(
        Order(1, NC, words={"filter_time_s": 0.012}), written={"dist_ctrl[0].n_cycles": 3},
        stems=OF_CHANNEL,
    )  # fmt: skip
    assert [one.listed.control.count for one in found] == [3, 12]


def test_what_was_on_before_an_error_begins_anew() -> None:
    """The rows say that it is off, whatever was commanded last."""
    found = acts(on(2), kp(5, 0.4, OBJECT), on(9), on={})
    assert found[-1].begins
    assert found[-1].listed.control.kp == 0.4


def test_a_control_that_is_commanded_in_the_first_row_begins() -> None:
    found = acts(on(0, PLC))
    assert [(one.row, one.begins, one.is_dry_run) for one in found] == [(0, True, False)]
    assert [(one.row, one.begins) for one in acts(on(0))] == [(0, False), (1, True)]


def test_a_dry_run_stays_one_with_a_word_and_ends_with_the_control() -> None:
    orders = (on(2, dry=True), kp(4, 0.3), Order(6, NC, "OFF", is_dry_run=True))
    found = acts(*orders, on={3: True, 5: True})
    assert [(one.row, one.is_dry_run) for one in found] == [
        (0, False), (3, True), (5, True), (7, False),
    ]  # fmt: skip


def test_two_orders_that_act_in_one_row_are_one() -> None:
    """The second is what acts, and what the first has begun has begun."""
    found = acts(on(2), kp(2, 0.6), Order(3, PLC, "FREEZE"), on={2: True})
    assert [(one.row, one.listed.control.kp, one.begins) for one in found] == [
        (0, 0.2, False), (3, 0.6, True),
    ]  # fmt: skip
    assert [one.begins for one in acts(kp(2, 0.6), on(2))] == [False, True]


@pytest.mark.parametrize(("time_s", "count"), [(0.0124, 12), (0.0126, 13), (0.001, 1)])
def test_a_filter_time_is_rounded_to_cycles(time_s: float, count: int) -> None:
    found = acts(Order(1, NC, words={"filter_time_s": time_s}))
    assert found[-1].listed.control.count == count


def test_a_command_for_what_is_on_already_begins_nothing() -> None:
    found = acts(on(6), on={5: True})
    assert [(one.row, one.begins) for one in found] == [(0, False), (7, False)]


@pytest.mark.parametrize("by", [NC, PLC])
@pytest.mark.parametrize("action", ["ON", "ON_CONST_DIST"])
def test_a_word_beside_the_command_is_later_than_an_object(by: str, action: str) -> None:
    """docs/ambiguities.md, "Parameters while control is on": of both the later one counts."""
    asked = Order(3, OBJECT, words={"kp": 0.4, "i_tn": 0.5})
    command = Order(9, by, action, words={"kp": 0.7, "v_max": 9000})
    (_, found) = acts(asked, command)
    assert (found.row, found.begins) == (9 + (by == NC), True)
    assert (found.listed.control.kp, found.listed.control.tn_s) == (0.7, 0.5)
    assert found.listed.limits.v_mm_s == 9.0
    # What the word has replaced does not come back when it is switched on again
    again = acts(asked, command, Order(20, by, "OFF"), Order(30, by, action))[-1]
    assert (again.listed.control.kp, again.listed.control.tn_s) == (0.7, 0.5)


@pytest.mark.parametrize("action", ["OFF", "FREEZE", ""])
def test_a_word_that_switches_nothing_on_leaves_objects_waiting(action: str) -> None:
    asked = Order(3, OBJECT, words={"kp": 0.4, "i_tn": 0.5})
    found = acts(asked, Order(5, PLC, action, words={"kp": 0.7}), on(9))
    assert [(one.row, one.listed.control.kp, one.listed.control.tn_s) for one in found] == [
        (0, 0.2, 0.0), (5, 0.7, 0.0), (10, 0.7, 0.5),
    ]  # fmt: skip


def test_an_object_acts_once() -> None:
    """A word after it stays, however often the control is switched on again."""
    orders = (kp(1, 0.4, OBJECT), on(2), kp(4, 0.6), Order(6, NC, "OFF"), on(8))
    assert kps(acts(*orders, on={3: True, 5: True})) == [
        (0, 0.2), (3, 0.4), (5, 0.6), (7, 0.6), (9, 0.6),
    ]  # fmt: skip


@pytest.mark.parametrize("action", ["ON", "ON_CONST_DIST"])
def test_each_command_that_switches_on_begins(action: str) -> None:
    """And is dry or not as it says itself."""
    for is_dry in (False, True):
        found = acts(Order(4, NC, action, is_dry), kp(4, 0.5))[-1]
        assert (found.row, found.begins, found.is_dry_run) == (5, True, is_dry)
        assert found.listed.control.kp == 0.5


@pytest.mark.parametrize("first", ["ON", "ON_CONST_DIST"])
@pytest.mark.parametrize("second", ["ON", "ON_CONST_DIST"])
def test_two_commands_of_one_cycle_begin_once(first: str, second: str) -> None:
    """An object between them waits: the control is on by then."""
    orders = (Order(4, NC, first), kp(4, 0.4, OBJECT), Order(4, NC, second))
    found = acts(*orders)
    assert [(one.row, one.begins, one.listed.control.kp) for one in found] == [
        (0, False, 0.2), (5, True, 0.2),
    ]  # fmt: skip


@pytest.mark.parametrize("turn", [1, -1])
@pytest.mark.parametrize("by", [NC, PLC])
def test_objects_of_several_parameters_wait_together(by: str, turn: int) -> None:
    """Whatever their order; one that is written again has its last value."""
    given = [kp(2, 0.3, OBJECT), Order(3, OBJECT, words={"i_tn": 0.5}), kp(4, 0.4, OBJECT),
             Order(5, OBJECT, words={"d_tv": 0.01})]  # fmt: skip
    control = acts(*given[::turn], on(9, by))[-1].listed.control
    assert (control.kp, control.tn_s, control.tv_s) == (0.4 if turn > 0 else 0.3, 0.5, 0.01)
    again = acts(*given, on(9), on(20), on={19: False})[-1].listed.control
    assert (again.kp, again.tn_s, again.tv_s) == (0.4, 0.5, 0.01)
