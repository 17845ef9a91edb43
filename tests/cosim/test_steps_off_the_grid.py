"""An FMU that has come to a fraction of a nanosecond: no later step loses or gains this fraction.

u = 100 mm/s, so that a quarter of a nanosecond is 2.5e-8 mm; x = u t to 1e-12 mm.
"""

from collections.abc import Callable
from typing import Any

import pytest
from tests.cosim.conftest import BEHAVIOURS

from axisrig.kernel.cosim.fmi.fmu import Exchange, FmuSlave, PlantError
from axisrig.kernel.time.clock import MS

Odd = Callable[..., FmuSlave]
ROUNDING_MM = 1e-12
PLACES = {"after": (1_500_000, 1_000_000.25), "before": (1_499_999, 999_999.75)}
"""From 500 000.5 ns on, half of a step to these ends: a quarter after 1 ms, and before it."""
FMI3 = pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
BOTH_SIDES = pytest.mark.parametrize("side", PLACES)


def saving(version: int) -> dict[str, bool]:
    """The flag of a state that can be saved, in the words of the version."""
    return {"canGetAndSetFMUstate" if version == 2 else "canGetAndSetFMUState": True}


def behaves(slave: FmuSlave, behaviour: str) -> None:
    slave.set_start("behaviour", BEHAVIOURS.index(behaviour))


def go_off(slave: FmuSlave, side: str) -> None:
    """Step to a place, by two steps that are discarded half way."""
    behaves(slave, "discards half way")
    end_ns, at_ns = PLACES[side]
    slave.step_towards(1_000_001)
    assert slave.step_towards(end_ns) == 1 * MS
    assert slave.get("slide.x") == pytest.approx(100.0 * 1e-9 * at_ns, abs=ROUNDING_MM)


def off_the_grid(odd: Odd, side: str, **promises: str | bool) -> FmuSlave:
    slave = odd(**promises)
    go_off(slave, side)
    return slave


def is_at(slave: FmuSlave, time_ns: int) -> None:
    assert slave.time_ns == time_ns
    assert slave.get("slide.x") == pytest.approx(100.0 * 1e-9 * time_ns, abs=ROUNDING_MM)


@BOTH_SIDES
def test_a_whole_step_ends_at_its_nanosecond(odd: Odd, side: str) -> None:
    slave = off_the_grid(odd, side)
    behaves(slave, "plain")
    assert slave.step_towards(2 * MS) == 2 * MS
    is_at(slave, 2 * MS)


@BOTH_SIDES
def test_a_part_of_a_discarded_step_ends_at_its_nanosecond(
    odd: Odd, version: int, side: str
) -> None:
    """2 ms are discarded, and so are 1 ms and 500 us; 250 us are done."""
    slave = off_the_grid(odd, side, **saving(version))
    behaves(slave, "discards long steps")
    assert slave.step_towards(3 * MS) == 1_250_000
    is_at(slave, 1_250_000)
    slave.step_to(3 * MS)
    is_at(slave, 3 * MS)


@FMI3
@BOTH_SIDES
@pytest.mark.parametrize("times", [1, 10])
def test_a_step_after_returns_without_progress_ends_at_its_nanosecond(
    odd: Odd, side: str, times: int
) -> None:
    """It may return ten times so, in every step anew."""
    slave = off_the_grid(odd, side, mightReturnEarlyFromDoStep=True)
    slave.set_start("scale", times)
    behaves(slave, "hesitates")
    for time_ns in (2 * MS, 3 * MS, 3 * MS + 1):
        assert slave.step_towards(time_ns) == time_ns
        is_at(slave, time_ns)


@FMI3
def test_an_eleventh_return_without_progress_is_one_too_many(odd: Odd) -> None:
    slave = odd("hesitates", mightReturnEarlyFromDoStep=True)
    slave.set_start("scale", 11)
    with pytest.raises(PlantError, match="returns early again and again without progress"):
        slave.step_to(1 * MS)


@BOTH_SIDES
def test_a_fraction_belongs_to_the_saved_state(odd: Odd, version: int, side: str) -> None:
    """To the state that has it, and not to one that was saved at a whole nanosecond."""
    slave = odd(**saving(version))
    begin = slave.save_state()
    go_off(slave, side)
    fraction = slave.save_state()
    for state, at_ns in ((fraction, 1 * MS), (begin, 0), (fraction, 1 * MS)):
        slave.restore_state(state)
        assert slave.time_ns == at_ns
        behaves(slave, "plain")
        slave.step_to(2 * MS)
        is_at(slave, 2 * MS)


@pytest.mark.parametrize("begin_ms", [0, 5, 70])
def test_time_begins_where_the_initialisation_says(odd: Odd, begin_ms: int) -> None:
    slave = odd()
    slave.initialize(begin_ms * MS)
    assert slave.time_ns == begin_ms * MS
    slave.step_to((begin_ms + 2) * MS)
    assert slave.time_ns == (begin_ms + 2) * MS
    assert slave.get("slide.x") == pytest.approx(0.2, abs=ROUNDING_MM)


# On a grid


def test_a_saved_state_knows_the_last_point_of_the_grid(odd: Odd, version: int) -> None:
    """Steps of 1 ms: at 2.5 ms the FMU is at 2, at 3.4 at 3; back at 2.5 it goes on from 2."""
    slave = odd(
        fixedInternalStepSize="1e-3", stepSize="1e-3",
        canHandleVariableCommunicationStepSize=False, **saving(version),
    )  # fmt: skip
    slave.step_to(2_500_000)
    state = slave.save_state()
    for _ in range(2):
        slave.step_to(3_400_000)
        assert slave.get("slide.x") == pytest.approx(0.3, abs=ROUNDING_MM)
        slave.restore_state(state)
        assert slave.time_ns == 2_500_000
        assert slave.get("slide.x") == pytest.approx(0.2, abs=ROUNDING_MM)
    slave.step_to(2_999_999)
    assert slave.get("slide.x") == pytest.approx(0.2, abs=ROUNDING_MM)
    slave.step_to(3 * MS)  # exactly at a point
    assert slave.get("slide.x") == pytest.approx(0.3, abs=ROUNDING_MM)


def test_a_grid_begins_at_the_initialisation(odd: Odd) -> None:
    """From 0.7 ms on it has points at 1.7 and 2.7 ms."""
    slave = odd(
        fixedInternalStepSize="1e-3", stepSize="1e-3",
        canHandleVariableCommunicationStepSize=False,
    )  # fmt: skip
    slave.initialize(700_000)
    for time_ns, x_mm in ((1_699_999, 0.0), (1_700_000, 0.1), (2_699_999, 0.1), (2_700_000, 0.2)):
        slave.step_to(time_ns)
        assert slave.get("slide.x") == pytest.approx(x_mm, abs=ROUNDING_MM)


# Many parts


def test_one_step_may_be_answered_in_a_thousand_parts(odd: Odd) -> None:
    slave = odd("creeps", mightReturnEarlyFromDoStep=True)
    slave.step_to(1 * MS)
    is_at(slave, 1 * MS)
    slave.step_to(2 * MS)  # counted anew
    is_at(slave, 2 * MS)


def test_a_step_in_more_parts_is_an_error_with_its_place(odd: Odd) -> None:
    slave = odd("creeps", mightReturnEarlyFromDoStep=True)
    slave.step_to(500_000)
    with pytest.raises(PlantError, match=r"plant odd at .*not at 1\.600000 ms after 1000 steps"):
        slave.step_to(1_600_000)
    assert 1_499_000 <= slave.time_ns < 1_600_000


def test_discarded_steps_are_tried_again_from_one_saved_state(odd: Odd, version: int) -> None:
    """However many there are: a long run would else keep a state of each."""
    slave = odd("discards long steps", **saving(version))
    own = slave.save_state()
    places: set[int] = set()
    save: Any = slave._save

    def watched(pointer: int, place: int) -> int:
        places.add(place)
        return int(save(pointer, place))

    slave._save = watched
    for end_ms in range(1, 21):
        slave.step_to(end_ms * MS)
    is_at(slave, 20 * MS)
    assert len(places) == 1
    slave.restore_state(own)  # which they leave alone
    is_at(slave, 0)


# After the end


def test_what_is_closed_takes_and_gives_nothing(odd: Odd) -> None:
    slave = odd()
    slave.close()
    slave.close()
    with pytest.raises(PlantError, match=r"plant odd at .*the instance is freed"):
        Exchange(slave, ["slide.x"])


def test_an_fmu_has_several_variables_if_it_has_each(odd: Odd) -> None:
    slave = odd()
    assert slave.has("slide.x", "slide.u")
    assert slave.has()
    for names in (("slide.x", "slide.y"), ("slide.y", "slide.x"), ("slide.y",)):
        assert not slave.has(*names)
    assert slave.names("output") == ["slide.x", "level"]
    assert slave.names("input") == ["slide.u"]
