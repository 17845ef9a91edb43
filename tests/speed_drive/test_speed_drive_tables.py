"""Tables of drives that only take a speed: each state with each input."""

import csv
from fractions import Fraction
from pathlib import Path

import pytest
from tests.speed_drive.ends import FAMILIES

from axisrig.bench.drive.speed_drive import front
from axisrig.bench.drive.speed_drive import latch as of_unit
from axisrig.bench.drive.speed_drive.latch import EnabledLatch
from axisrig.kernel.drives.speed_drive import latch as of_control
from axisrig.kernel.drives.speed_drive.latch import LatchControl

S, E = of_control.LatchState, of_control.LatchInput
U, V = of_unit.LatchState, of_unit.LatchInput


@pytest.mark.parametrize(
    ("module", "name", "states", "inputs"),
    [
        (of_control, "latch", S, E),
        (of_unit, "latch", U, V),
        (front, "power", front.PowerState, front.PowerInput),
    ],
)
def test_each_state_has_each_input_once(
    module: object, name: str, states: type, inputs: type
) -> None:
    here = Path(str(module.__file__)).parent  # type: ignore[attr-defined]
    text = (here / f"{name}.csv").read_text(encoding="utf-8")
    rows = [(row["state"], row["input"]) for row in csv.DictReader(text.splitlines())]
    expected = [(state.name, asked.name) for state in states for asked in inputs]  # type: ignore[attr-defined]
    assert sorted(rows) == sorted(expected)


@pytest.mark.parametrize("state", front.PowerState)
@pytest.mark.parametrize("asked", front.PowerInput)
def test_power_needs_the_enable(state: front.PowerState, asked: front.PowerInput) -> None:
    command = front.COMMANDS[state, asked]
    has_power = state in (front.PowerState.ON, front.PowerState.OPERATION)
    is_enabled = asked is front.PowerInput.ENABLE
    assert (command == "OPERATE") is (is_enabled and has_power)
    is_reset = state is front.PowerState.FAULT and asked is front.PowerInput.RESET
    assert (command == "RESET") is is_reset
    assert command in front.CONTROLWORD


@pytest.mark.parametrize("state", S)
@pytest.mark.parametrize("asked", E)
def test_what_the_control_takes_for_a_value(
    state: of_control.LatchState, asked: of_control.LatchInput
) -> None:
    """Only the same value twice, after ARM from CLEAR, and never once it has been lost."""
    after = of_control.TABLE[state, asked]
    if after is S.VALUE:
        assert (state, asked) in {(S.STORED, E.SAME), *((S.VALUE, i) for i in E)}
    if after is S.ARMING:
        assert state is S.ARMING or (state, asked) == (S.CLEAR, E.ARM)
    if after is S.CLEAR:
        assert state is S.CLEAR or (state, asked) == (S.IDLE, E.LOW)
    if asked is E.DISARM:
        assert after is (S.CLEAR if state is S.CLEAR else S.IDLE)
    if state in (S.STORED, S.VALUE, S.LOST) and asked is E.LOW:
        assert after is S.LOST


@pytest.mark.parametrize("state", U)
@pytest.mark.parametrize("asked", V)
def test_what_the_unit_stores(state: of_unit.LatchState, asked: of_unit.LatchInput) -> None:
    """It is armed from OFF alone: enabled before the valid bit is low it keeps the old value."""
    latch = EnabledLatch()
    latch.state, latch.value = state, 7
    if asked is V.PULSE:
        latch.pulse(9)
    else:
        latch.enable(is_enabled=asked is V.ENABLE)
    assert latch.state is of_unit.TABLE[state, asked]
    assert latch.value == (9 if (state, asked) == (U.ARMED, V.PULSE) else 7)
    is_fresh = (state, asked) == (U.OFF, V.ENABLE)
    is_kept = (state, asked) == (U.ARMED, V.ENABLE)
    assert latch.is_armed is (is_fresh or is_kept)
    if (state, asked) == (U.CLEARING, V.ENABLE):
        assert latch.is_valid


@pytest.mark.parametrize("state", U)
def test_power_takes_what_the_unit_has_stored(state: of_unit.LatchState) -> None:
    latch = EnabledLatch()
    latch.state, latch.value = state, 7
    latch.reset()
    assert (latch.state, latch.value) == (U.OFF, 0)
    assert (latch.is_armed, latch.is_valid) == (False, False)
    latch.enable(is_enabled=True)
    latch.pulse(9)
    assert (latch.value, latch.is_valid) == (9, True)


# The control's side


@pytest.fixture
def armed() -> LatchControl:
    """A latch that is enabled, two telegrams after the order."""
    latch = LatchControl(echo_cycles=2)
    show(latch, None, None, None)
    assert latch.is_clear
    latch.arm()
    show(latch, None, None)
    assert latch.is_armed
    return latch


def show(latch: LatchControl, *values: int | None) -> None:
    for value in values:
        latch.take(value, 100, -4)


def test_two_telegrams_with_the_same_are_a_value(armed: LatchControl) -> None:
    show(armed, 5)
    assert (armed.has_latched, armed.value) == (True, None)
    show(armed, 5)
    assert (armed.value, armed.place, armed.travel) == (5, 100, -4)


def test_a_value_that_changes_is_none(armed: LatchControl) -> None:
    show(armed, 5, 6, 7)
    assert armed.value is None
    show(armed, 7, 8)
    assert (armed.value, armed.has_latched) == (None, False)


def test_a_valid_bit_that_falls_takes_the_value_with_it(armed: LatchControl) -> None:
    show(armed, 5, None, 5, 5)
    assert (armed.value, armed.has_latched) == (None, False)


def test_what_was_made_before_the_order_is_no_value() -> None:
    latch = LatchControl(echo_cycles=2)
    show(latch, None, None)
    latch.arm()
    show(latch, 5)
    assert not latch.has_latched
    show(latch, 5)  # the first one after it, whatever that of before had
    assert (latch.has_latched, latch.value) == (True, None)
    show(latch, 5)
    assert latch.value == 5


def test_it_is_not_enabled_while_a_bit_is_high(armed: LatchControl) -> None:
    """Both have to be low once: the enable bit by the unit, the valid bit by the control."""
    show(armed, 5, 5)
    armed.disarm()
    assert (armed.is_ordered, armed.is_clear) == (False, False)
    show(armed, None)  # made before the unit saw the enable bit low
    assert not armed.is_clear
    show(armed, 5, 5)
    armed.arm()
    assert not armed.is_ordered
    show(armed, None)
    assert armed.is_clear


@pytest.mark.parametrize("values", [(5,), (5, 5), (5, 6)])
def test_a_value_that_comes_when_nobody_waits_is_not_clear(values: tuple[int, ...]) -> None:
    """So the next run does not take it for its own: it begins when the valid bit is low again."""
    latch = LatchControl(echo_cycles=2)
    show(latch, None, None, None)
    assert latch.is_clear
    show(latch, *values)
    assert not latch.is_clear
    latch.arm()
    show(latch, values[-1], values[-1], values[-1])
    assert (latch.is_ordered, latch.has_latched, latch.value) == (False, False, None)
    show(latch, None)
    assert latch.is_clear
    latch.arm()
    show(latch, None, None)
    assert latch.is_armed


@pytest.mark.parametrize("state", S)
def test_what_a_state_of_the_control_does_with_each_telegram(state: of_control.LatchState) -> None:
    """Of OLD nothing; without an order LOW alone is clear; an order is taken back at once."""
    after = {asked: of_control.TABLE[state, asked] for asked in E}
    assert after[E.OLD] is state
    if state in (S.IDLE, S.CLEAR):
        assert (after[E.LOW], after[E.NEW], after[E.SAME]) == (S.CLEAR, S.IDLE, S.IDLE)
        assert after[E.ARM] is (S.ARMING if state is S.CLEAR else S.IDLE)
    else:
        assert after[E.ARM] is state
        assert after[E.DISARM] is S.IDLE
    if state in (S.ARMING, S.ARMED):
        assert (after[E.LOW], after[E.NEW], after[E.SAME]) == (S.ARMED, S.STORED, S.STORED)
    if state is S.STORED:
        assert (after[E.NEW], after[E.SAME]) == (S.STORED, S.VALUE)
    if state is S.VALUE:
        assert (after[E.NEW], after[E.SAME]) == (S.LOST, S.VALUE)
    if state is S.LOST:
        assert {after[asked] for asked in (E.LOW, E.NEW, E.SAME)} == {S.LOST}


def test_a_latched_value_has_increments_of_its_own_on_lightbus() -> None:
    """LATCH32 counts um, LATCH16 divides a turn of 10 mm; the others latch their counter."""
    latched = {name: family.table.facts().latch_per_mm for name, family in FAMILIES.items()}
    assert latched == {"conventional": None, "encoder_terminal": None, "lightbus": 1000}
    in_turn = FAMILIES["lightbus"].table.changed("latch_variable", "LATCH16")
    assert in_turn.facts().latch_per_mm == Fraction(65_536, 10)
