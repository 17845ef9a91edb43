"""How the filter of the sensor goes on, begins anew and is refused while the control runs."""

from collections.abc import Callable
from typing import Any

import pytest

from axisrig.kernel.distance import DistanceCommand, DistanceState
from axisrig.kernel.errors import Alarm

Make = Callable[..., Any]
Command, State = DistanceCommand, DistanceState
MODES = [(Command.ON, State.ACTIVE), (Command.ON_CONST_DIST, State.ACTIVE_CONST_DIST)]


def started(loop: Any, mode: Command = Command.ON) -> Any:
    loop.control.set_surface(0.0)
    loop.control.set_distance(0.0)
    return loop.say(mode)


@pytest.mark.parametrize(
    "kind", ["MOVING_AVERAGE", "EXPO_MEAN", "LOWPASS", "KALMAN_MA", "KALMAN_EXPO", "DEFAULT"]
)
@pytest.mark.parametrize(("mode", "_state"), MODES)
def test_another_filter_goes_on_from_what_was_given_last(
    make_loop: Make, mode: Command, _state: State, kind: str
) -> None:
    """A constant sensor: the change is not seen at all."""
    loop = started(make_loop(lambda _k: 1.0, n_cycles=9, kp=0.01, max_deviation_mm=1e3), mode)
    loop.run(3).say(mode, dry_run=True).run(40)
    before = loop.control.filtered_mm
    loop.control.program(filter_type=kind, n_cycles=20, smoothing_factor=0.2)
    assert loop.run(1).control.filtered_mm == pytest.approx(before, abs=1e-12)


SAME = [
    ({}, {"n_cycles": 9}),
    ({}, {"filter_type": "MOVING_AVERAGE"}),  # what DEFAULT is
    ({}, {"kalman_sigma": 5.0, "smoothing_factor": 0.2, "low_pass_filter_order": 2}),
    ({"filter_type": "EXPO_MEAN"}, {"kalman_sigma": 5.0, "low_pass_filter_fg_f0": 50.0}),
    ({"filter_type": "LOWPASS"}, {"n_cycles": 3, "smoothing_factor": 0.2}),
    ({"filter_type": "KALMAN_MA"}, {"smoothing_factor": 0.2}),
]
OTHER = [
    ({}, {"n_cycles": 8}),
    ({"filter_type": "EXPO_MEAN"}, {"smoothing_factor": 0.2}),
    ({"filter_type": "LOWPASS"}, {"low_pass_filter_order": 2}),
    ({"filter_type": "LOWPASS"}, {"low_pass_filter_fg_f0": 50.0}),
    ({"filter_type": "KALMAN_MA"}, {"kalman_sigma": 5.0}),
]


def filtered(
    make_loop: Make, begin: dict[str, Any], words: dict[str, Any], how: str
) -> list[float]:
    """What the filter gives of a surface that rises, from where it gets other parameters on."""
    found = []
    loop = started(make_loop(lambda k: 1e-3 * k, kp=0.05, **{"n_cycles": 9, **begin})).run(40)
    if how == "program":
        loop.control.program(**words)
    else:  # taken when it is switched on again
        for name, value in words.items():
            loop.control.request(name, value)
        loop.say(Command.FREEZE, Command.ON)
    for _ in range(12):
        found.append(loop.run(1).control.filtered_mm)
    return found


@pytest.mark.parametrize("how", ["program", "objects"])
@pytest.mark.parametrize(("begin", "words"), SAME)
def test_a_parameter_that_does_not_act_leaves_the_filter_alone(
    make_loop: Make, begin: dict[str, Any], words: dict[str, Any], how: str
) -> None:
    assert filtered(make_loop, begin, words, how) == filtered(make_loop, begin, {}, how)


@pytest.mark.parametrize("how", ["program", "objects"])
@pytest.mark.parametrize(("begin", "words"), OTHER)
def test_a_parameter_that_acts_makes_another_filter(
    make_loop: Make, begin: dict[str, Any], words: dict[str, Any], how: str
) -> None:
    assert filtered(make_loop, begin, words, how) != filtered(make_loop, begin, {}, how)


def test_the_filter_begins_with_the_first_value(make_loop: Make) -> None:
    loop = started(make_loop(lambda _k: 0.4, n_cycles=50, kp=0.1)).run(1)
    assert loop.control.filtered_mm == 0.4


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("kind", ["MOVING_AVERAGE", "EXPO_MEAN", "LOWPASS"])
def test_another_mode_begins_its_filter_with_its_own_first_value(
    make_loop: Make, kind: str, first: int
) -> None:
    """A dry run moves nothing: what is filtered is what a control without a filter reads.

    SET_POS filters a position, CONST_DIST a distance: a mean of both would be neither. Back in the
    first mode it is its own value again.
    """
    modes = [MODES[first][0], MODES[1 - first][0], MODES[first][0]]
    loops = [
        make_loop(lambda k: 0.4 + 0.01 * k, program_mm=2.0, kp=0.1, filter_type=kind, n_cycles=n)
        for n in (9, 1)
    ]
    if kind == "LOWPASS":
        loops[1] = make_loop(lambda k: 0.4 + 0.01 * k, program_mm=2.0, kp=0.1, n_cycles=1)
    for loop in loops:
        started(loop, modes[0])
    for mode in modes:
        for loop in loops:
            loop.say(mode, dry_run=True).run(1)
        assert loops[0].control.filtered_mm == loops[1].control.filtered_mm
        for loop in loops:
            loop.run(20)


def test_the_filter_goes_on_in_freeze(make_loop: Make) -> None:
    loop = started(make_loop(lambda k: 0.001 * k, n_cycles=5, kp=0.1)).run(20)
    loop.say(Command.FREEZE).run(20).say(Command.ON).run(1)
    assert loop.control.filtered_mm == pytest.approx(0.001 * (40 - 2))


def test_a_filter_that_cannot_be_is_refused_when_it_is_needed(make_loop: Make) -> None:
    loop = make_loop()
    loop.control.program(filter_type="LOWPASS", low_pass_filter_fg_f0=600.0)
    loop.control.set_surface(0.0)
    with pytest.raises(Alarm, match=r"ID 310001 class 7.* axis Z"):
        loop.say(Command.ON)
    assert loop.control.state is State.INACTIVE
    loop.control.program(low_pass_filter_fg_f0=50.0)
    loop.say(Command.ON).run(1)
    with pytest.raises(Alarm, match="ID 310001"):
        loop.control.program(low_pass_filter_fg_f0=500.0)
    assert loop.control.settings.filter.low_pass_filter_fg_f0 == 50.0
