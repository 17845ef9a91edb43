"""Writes that a drive refuses in its state, by its plant and by what it has."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.refusals import refusal
from axisrig.kernel.profiles.cia402.ds402 import State

INVALID, NOT_NOW = 0x06090030, 0x08000022

POWERED = {
    State.SWITCHED_ON,
    State.OPERATION_ENABLED,
    State.QUICK_STOP_ACTIVE,
    State.FAULT_REACTION_ACTIVE,
}


def _refused(index: int, value: int, state: State = State.SWITCH_ON_DISABLED, **given: Any) -> Any:
    image = ProcessImage(controlword=given.pop("controlword", 0x0F))
    motion: Any = SimpleNamespace(controls_velocity=given.pop("controls_velocity", True))
    return refusal(index, value, {1, 8}, DriveProfile(**given), motion, state, image)


@pytest.mark.parametrize("state", State)
@pytest.mark.parametrize("index", [0x608F, 0x6091, 0x6092, 0x60E6, 0x60EB])
def test_scaling_waits_for_a_state_without_power(index: int, state: State) -> None:
    """CiA 402-2: power may be at the motor from switched on to the end of a fault reaction."""
    assert _refused(index, 1, state) == (NOT_NOW if state in POWERED else None)
    assert _refused(0x6083, 1, state) is None


@pytest.mark.parametrize(
    ("index", "value"),
    [
        *((0x605A, value) for value in range(9)),
        *((index, value) for index in (0x605B, 0x605C) for value in (0, 1)),
        *((0x605D, value) for value in range(1, 5)),
        *((0x605E, value) for value in range(5)),
    ],
)
def test_a_plant_of_positions_cannot_brake_with_a_limit(index: int, value: int) -> None:
    """605A: 3, 4, 7, 8; 605D and 605E: 3, 4 brake with the current or the voltage limit."""
    by_limit = value in ((3, 4, 7, 8) if index == 0x605A else (3, 4))
    assert _refused(index, value, controls_velocity=False) == (INVALID if by_limit else None)
    assert _refused(index, value) is None


def test_a_mode_is_one_that_the_drive_has_and_at_a_time_that_it_takes() -> None:
    halted = 0x010F
    for value, refused in ((1, None), (8, None), (3, INVALID), (0, INVALID)):
        assert _refused(0x6060, value) == refused
        assert _refused(0x6060, value, controlword=halted) == refused
        assert _refused(0x6060, value, mode_change="not_halted") == refused
        late = _refused(0x6060, value, controlword=halted, mode_change="not_halted")
        assert late == (refused or NOT_NOW)
    assert _refused(0x6083, 1, controlword=halted, mode_change="not_halted") is None


def test_a_drive_with_fewer_option_codes_takes_these_alone() -> None:
    for value in range(9):
        taken = _refused(0x605A, value, option_codes="605A:2,6 605E:2,0")
        assert taken == (None if value in (2, 6) else INVALID)
    assert _refused(0x605E, 1, option_codes="605A:2,6 605E:2,0") == INVALID
    assert _refused(0x605C, 1, option_codes="605A:2,6 605E:2,0") is None
