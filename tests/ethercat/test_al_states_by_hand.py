"""The state machine of a slave alone: waiting for OP, falls, and who follows its changes."""

import pytest

from axisrig.bench.drive.ethercat.al_states import WAITS, AlStateMachine
from axisrig.kernel.profiles.ethercat.tables import AlState, al_status_codes


class Behaviour:
    """Every state is entered at once but for those in `answers`; left: from, to and code."""

    def __init__(self) -> None:
        self.answers: dict[AlState, str | None] = {}
        self.left: list[tuple[str, str, str]] = []

    def enter(self, state: AlState) -> str | None:
        return self.answers.get(state)

    def leave(self, before: AlState, after: AlState, code: str) -> None:
        self.left.append((before.name, after.name, code))


class States:
    """The machine in SAFEOP; shown: AL status and code that it has shown last."""

    def __init__(self) -> None:
        self.behaviour, self.shown = Behaviour(), (0, 0)
        self.machine = AlStateMachine(self.behaviour, self._show)
        for state in (AlState.PREOP, AlState.SAFEOP):
            self.machine.control(state)

    def _show(self, status: int, code: int) -> None:
        self.shown = status, code


@pytest.mark.parametrize(
    ("requested", "shown"),
    [
        (AlState.SAFEOP, (4, 0)),
        (AlState.PREOP, (2, 0)),
        (AlState.INIT, (1, 0)),
        (5, (4 | 0x10, al_status_codes()["UNKNOWN_STATE"])),
    ],
)
def test_a_wait_for_op_ends_with_any_other_request(requested: int, shown: tuple[int, int]) -> None:
    states = States()
    states.behaviour.answers[AlState.OP] = WAITS
    states.machine.control(AlState.OP)
    assert (states.machine.is_waiting, states.shown) == (True, (4, 0))
    states.machine.control(requested)
    assert (states.machine.is_waiting, states.shown) == (False, shown)


def test_op_comes_when_it_arrives_or_is_refused() -> None:
    states = States()
    states.behaviour.answers[AlState.OP] = WAITS
    states.machine.control(AlState.OP)
    states.machine.refuse("NO_SYNC")
    code = al_status_codes()["NO_SYNC"]
    assert (states.machine.is_waiting, states.shown) == (False, (4 | 0x10, code))
    states.machine.control(AlState.OP)  # not acknowledged
    assert states.shown == (4 | 0x10, code)
    states.machine.control(AlState.OP | 0x10)
    assert (states.machine.is_waiting, states.shown) == (True, (4, 0))
    states.machine.arrive()
    assert (states.machine.is_waiting, states.machine.state, states.shown) == (
        False, AlState.OP, (8, 0)
    )  # fmt: skip


def test_a_fall_goes_down_only() -> None:
    states = States()
    for state in (AlState.SAFEOP, AlState.OP):
        states.machine.fall(state, "WATCHDOG")
        assert (states.shown, states.behaviour.left) == ((4, 0), [])
    states.machine.fall(AlState.PREOP, "INVALID_OUTPUTS")
    assert states.behaviour.left == [("SAFEOP", "PREOP", "INVALID_OUTPUTS")]
    assert states.shown == (2 | 0x10, al_status_codes()["INVALID_OUTPUTS"])
    states.machine.control(AlState.INIT)  # needs no acknowledge
    assert states.shown == (1, 0)
    assert states.behaviour.left[1:] == [("PREOP", "INIT", "")]


def test_each_change_is_reported_to_those_who_follow() -> None:
    states = States()
    reported: list[tuple[str, int]] = []
    states.machine.observers.append(lambda state, code: reported.append((state.name, code)))
    states.machine.control(AlState.OP)
    states.machine.fall(AlState.SAFEOP, "WATCHDOG")
    states.machine.reset()
    assert reported == [("OP", 0), ("SAFEOP", al_status_codes()["WATCHDOG"])]
    assert (states.machine.state, states.machine.code) == (AlState.INIT, 0)


@pytest.mark.parametrize("code", ["", "NO_SYNC"])
def test_power_ends_a_wait_and_takes_an_error(code: str) -> None:
    """All begins in INIT, and OP is waited for anew."""
    states = States()
    states.behaviour.answers[AlState.OP] = WAITS
    for _ in range(2):
        states.machine.control(AlState.OP)
        assert states.machine.is_waiting
        if code:
            states.machine.refuse(code)
        states.machine.reset()
        machine = states.machine
        assert (machine.state, machine.code, machine.is_waiting) == (AlState.INIT, 0, False)
        for state in (AlState.PREOP, AlState.SAFEOP):
            machine.control(state)
            assert states.shown == (state, 0)


def test_two_refusals_one_after_the_other_have_a_code_each() -> None:
    states = States()
    states.machine.control(AlState.INIT)
    states.machine.control(AlState.OP)  # there is no such way
    assert states.shown == (1 | 0x10, al_status_codes()["INVALID_STATE_CHANGE"])
    states.machine.control(0x10 | 5)
    assert states.shown == (1 | 0x10, al_status_codes()["UNKNOWN_STATE"])


@pytest.mark.parametrize("after", [AlState.PREOP, AlState.INIT])
def test_a_fall_ends_the_wait_for_op(after: AlState) -> None:
    """What was waited for is no more to come; OP is asked for anew."""
    states = States()
    states.behaviour.answers[AlState.OP] = WAITS
    states.machine.control(AlState.OP)
    states.machine.fall(after, "INVALID_INPUTS")
    assert (states.machine.is_waiting, states.machine.state) == (False, after)
    assert states.shown == (after | 0x10, al_status_codes()["INVALID_INPUTS"])
