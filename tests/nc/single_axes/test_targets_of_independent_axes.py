"""Where an independent axis goes: absolute and relative, inch, offsets, and one speed alone."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from axis_statements import alone, decode, moves, path, single

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc.canon import IndependentMove, LinearMove
from axisrig.kernel.nc.coordinates.tables import Lists
from axisrig.kernel.nc.syntax import Number, Words

NAMES = ("INDP_SYN", "INDP_ASYN")


def functions(*names: str) -> Words:
    return Words(g=names)


def targets(*statements: Any) -> list[float]:
    return [move.target_mm for move in moves(decode(*statements))]


def move_of(*statements: Any) -> IndependentMove:
    (move,) = moves(decode(*statements))
    return move


# Absolute and relative


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("modal", "own", "goes_to"),
    [
        # X stands at 10, and POS is 4
        ("G90", (), 4.0), ("G91", (), 14.0),
        ("G90", ("G91",), 14.0), ("G91", ("G90",), 4.0),
        ("G90", ("G90",), 4.0), ("G91", ("G91",), 14.0),
    ],
)  # fmt: skip
def test_without_a_word_of_its_own_the_modal_one_counts(
    name: str, modal: str, own: tuple[str, ...], goes_to: float
) -> None:
    """TF5200 programming manual 208612235."""
    axis = alone("X", *own, "G0", POS=4, name=name)
    assert targets(path(X=10.0), functions(modal), single(axis)) == [goes_to]
    shifted = alone("X", *own, "G0", "INCL_OFFSETS", POS=4, name=name)
    assert targets(path(X=10.0), functions(modal), single(shifted)) == [goes_to]


def test_the_word_of_an_axis_is_for_its_own_motion_alone() -> None:
    """Neither another axis of the block, nor the path, nor what comes later takes it over."""
    own, other = alone("X", "G91", "G0", POS=4), alone("Y", "G0", POS=4)
    commands = decode(path(X=1.0, Y=1.0), single(own, other), path(X=6.0), single(alone("X", "G0",
                      POS=7)))  # fmt: skip
    assert [(move.axis, move.target_mm) for move in moves(commands)] == [
        ("X", 5.0), ("Y", 4.0), ("X", 7.0),
    ]  # fmt: skip
    last = [each.target_mm for each in commands if isinstance(each, LinearMove)][-1]
    assert last == {"X": 6.0}


def test_a_change_of_the_modal_word_counts_from_its_own_block_on() -> None:
    step = alone("X", "G0", POS=2)
    with_it = replace(single(step), g=("G91",))
    assert targets(single(step), with_it, single(step), functions("G90"), single(step)) == [
        2.0, 4.0, 6.0, 2.0,
    ]  # fmt: skip


@pytest.mark.parametrize("modal", ["G90", "G91"])
def test_a_measuring_run_goes_where_the_modal_word_says(modal: str) -> None:
    run = alone("X", "G100", POS=5, FEED=100)
    move = move_of(path(X=10.0), functions(modal), single(run))
    assert (move.target_mm, move.measuring_type) == (15.0 if modal == "G91" else 5.0, 1)


# Inch and degrees


@pytest.mark.parametrize("name", NAMES)
def test_inches_are_those_of_positions_and_feeds_of_linear_axes(name: str) -> None:
    """G70: 2 inches are 50.8 mm, and 3 inches a minute 76.2 mm/min."""
    linear = alone("X", "G90", "G1", POS=2, FEED=3, name=name)
    back = alone("X", "G91", "G0", POS=-1, name=name)
    move, relative = moves(decode(functions("G70"), single(linear), single(back)))
    assert (move.target_mm, move.feed_mm_min) == pytest.approx((50.8, 76.2), rel=1e-12)
    assert relative.target_mm == pytest.approx(25.4, rel=1e-12)
    metric = alone("X", "G90", "G1", POS=2, FEED=3, name=name)
    move = move_of(functions("G70"), functions("G71"), single(metric))
    assert (move.target_mm, move.feed_mm_min) == (2.0, 3.0)


def test_a_rotary_axis_has_degrees_in_inches_too(run: Callable[..., list[Any]]) -> None:
    tables = Lists().tables(rotary=("C",), ball_radius_counts=True)
    text = "G70\nC[INDP_SYN G90 G1 POS=90 FEED=30]\nC[INDP_SYN G91 G0 POS=-45]"
    first, second = moves(run(text, axes=("X", "Y", "Z", "C"), tables=tables))
    assert (first.target_mm, first.feed_mm_min, second.target_mm) == (90.0, 30.0, 45.0)


def test_a_time_and_a_share_are_no_lengths() -> None:
    timed = alone("X", "G90", "G1", POS=1, TIME=3)
    shared = alone("Y", "G90", "G1", POS=1, FEED_MAX_WEIGHT=50)
    x, y = moves(decode(functions("G70"), single(timed, shared)))
    assert (x.time_s, x.feed_mm_min, x.speed_share) == (3.0, None, None)
    assert (y.time_s, y.feed_mm_min, y.speed_share) == (None, None, 0.5)


# Offsets


@pytest.mark.parametrize(("words", "goes_to"), [((), 14.0), (("INCL_OFFSETS",), 14.0)])
def test_a_relative_way_is_the_same_with_and_without_offsets(
    words: tuple[str, ...], goes_to: float
) -> None:
    shift = Words(g=("G92",), axes=(("X", Number(3.0)),))
    axis = alone("X", "G91", "G0", *words, POS=4)
    first = alone("X", "G90", "G0", POS=10)
    assert targets(single(first), shift, single(axis)) == [10.0, goes_to]


@pytest.mark.parametrize("position", [10.0, 7.0])
def test_an_axis_that_stands_at_its_target_does_not_move(position: float) -> None:
    """X stands at 10 of the axis, which are 7 with the shift by 3."""
    shift = Words(g=("G92",), axes=(("X", Number(3.0)),))
    first = alone("X", "G90", "G0", POS=10)
    for words, stands in (((), 10.0), (("INCL_OFFSETS",), 7.0)):
        axis = alone("X", "G90", "G0", *words, POS=position)
        found = targets(single(first), shift, single(axis))
        goes_to = position + 3.0 if words else position
        assert found == ([10.0] if position == stands else [10.0, goes_to])


# One speed, one motion


def alarm_of(*statements: Any) -> Alarm:
    with pytest.raises(Alarm) as caught:
        decode(*statements)
    return caught.value


SPEEDS = {"FEED": 5, "TIME": 5, "FEED_MAX_WEIGHT": 5}


@pytest.mark.parametrize("word", SPEEDS)
def test_a_speed_alone_means_g01(word: str) -> None:
    move = move_of(single(alone("X", POS=1, **{word: 5})))
    found = {"FEED": move.feed_mm_min, "TIME": move.time_s, "FEED_MAX_WEIGHT": move.speed_share}
    assert found[word] == (0.05 if word == "FEED_MAX_WEIGHT" else 5.0)
    assert [value for key, value in found.items() if key != word] == [None, None]


@pytest.mark.parametrize("word", SPEEDS)
def test_rapid_traverse_has_no_speed_of_its_own(word: str) -> None:
    alarm = alarm_of(single(alone("X", "G0", POS=1, **{word: 5})))
    assert (alarm.id, alarm.values) == (50603, {"axis": "X", "option": f"{word} with G00"})


@pytest.mark.parametrize(
    ("words", "values", "what"),
    [
        (("G0", "G1"), {"FEED": 5}, "G0 and G1 at a time"),
        (("G1", "G100"), {"FEED": 5}, "G1 and G100 at a time"),
        (("G0", "G1", "G100"), {}, "G0 and G1 and G100 at a time"),
        ((), {}, "no G00 or G01 or G100 or speed"),
        (("G1",), {"FEED": 5, "FEED_MAX_WEIGHT": 5}, "FEED and FEED_MAX_WEIGHT at a time"),
        (("G100",), {"TIME": 5, "FEED_MAX_WEIGHT": 5}, "TIME and FEED_MAX_WEIGHT at a time"),
        (("G100",), {}, "no FEED or TIME or FEED_MAX_WEIGHT"),
        (("G0", "G90", "G91"), {}, "G90 and G91 at a time"),
    ],
)
def test_what_excludes_each_other_or_is_lacking_is_named(
    words: tuple[str, ...], values: dict[str, int], what: str
) -> None:
    alarm = alarm_of(functions("G91"), single(alone("X", *words, POS=1, **values)))
    assert (alarm.id, alarm.values) == (900194, {"axis": "X", "what": what})
    assert "N20" in alarm.place


@pytest.mark.parametrize(
    ("word", "motion", "values"),
    [
        ("ACC_WEIGHT", "G1", {"FEED": 5}), ("ACC_WEIGHT", "G100", {"FEED": 5}),
        ("RAPID_ACC_WEIGHT", "G0", {}), ("FEED_MAX_WEIGHT", "G1", {}),
    ],
)  # fmt: skip
def test_a_weight_is_a_share_of_100_percent(word: str, motion: str, values: dict[str, int]) -> None:
    for percent, share in ((100, 1.0), (25, 0.25), (0.5, 0.005)):
        move = move_of(single(alone("X", motion, POS=1, **values, **{word: percent})))
        found = move.speed_share if word == "FEED_MAX_WEIGHT" else move.acceleration_share
        assert found == share
    for percent in (0, -1, 100.5):
        alarm = alarm_of(single(alone("X", motion, POS=1, **values, **{word: percent})))
        assert (alarm.id, alarm.values) == (50603, {"axis": "X", "option": f"{word}={percent:g}"})


def test_the_weight_of_the_other_motion_does_not_count() -> None:
    feed = alone("X", "G1", POS=1, FEED=5, RAPID_ACC_WEIGHT=25)
    rapid = alone("Y", "G0", POS=1, ACC_WEIGHT=25)
    assert [m.acceleration_share for m in moves(decode(single(feed, rapid)))] == [1.0, 1.0]


def test_the_alarm_of_a_run_without_a_way_is_that_of_its_own_axis() -> None:
    """Relative by 0, and absolute to where it stands; a motion without measuring is nothing."""
    for modal, position in (("G91", 0), ("G90", 10)):
        run = alone("X", "G100", POS=position, FEED=5)
        alarm = alarm_of(path(X=10.0), functions(modal), single(run))
        assert (alarm.id, alarm.values) == (900103, {"axes": "X"})
        plain = alone("X", "G1", POS=position, FEED=5)
        assert targets(path(X=10.0), functions(modal), single(plain)) == []


def test_an_axis_is_once_in_a_block() -> None:
    """Twice by itself, or by itself and on the path."""
    x, again, y = (alone(a, "G0", POS=1) for a in "XXY")
    for words in (single(x, again), single(x, X=1.0), single(y, x, X=1.0)):
        alarm = alarm_of(words)
        assert (alarm.id, alarm.values) == (20203, {"axis": "X"})
    assert len(moves(decode(single(x, y, Z=1.0)))) == 2


@pytest.mark.parametrize("word", ["G2", "G101", "G92", "G4"])
def test_other_functions_are_not_for_an_independent_axis(word: str) -> None:
    alarm = alarm_of(single(alone("X", word, "G0", POS=1)))
    assert (alarm.id, alarm.values) == (21068, {"g_function": word, "axis": "X"})
