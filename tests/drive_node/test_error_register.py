"""The error register with its messages, and what a lost connection adds to it."""

from typing import Any

import pytest
from tests.drive_node.servo_alone import PER_M, ServoAlone

from axisrig.bench.drive.cia402.dictionary.image import DeviceImage
from axisrig.bench.drive.cia402.error_register import (
    COMMUNICATION_ERROR,
    PROFILE_ERROR,
    ErrorRegister,
)
from axisrig.kernel.profiles.cia402.ds402 import State

GENERIC = 1 << 0
INVALID, NOT_NOW = 0x06090030, 0x08000022


@pytest.fixture
def errors() -> tuple[ErrorRegister, DeviceImage, list[tuple[int, int, int]]]:
    image, sent = DeviceImage(), []
    return ErrorRegister(image, lambda *message: sent.append(message)), image, sent


def test_two_sources_of_one_code_are_one_message_and_one_end(errors: Any) -> None:
    """CiA 301: code and register with an error, code 0000 when it has gone from the last source."""
    register, image, sent = errors
    register.report(0x8250, COMMUNICATION_ERROR, 0, info=1)
    register.report(0x8250, COMMUNICATION_ERROR, 1, info=2)
    register.report(0x8250, COMMUNICATION_ERROR, 1, info=2)
    assert sent == [(0x8250, 0x11, 1)]
    register.clear(0x8250, 0)
    assert (sent[1:], image.error_register) == ([], 0x11)
    assert register.is_active(0x8250)
    register.clear(0x8250, 0)  # gone already
    register.clear(0x8250, 1)
    assert sent[1:] == [(0x0000, 0x00, 0)]
    assert (image.error_register, register.is_active(0x8250)) == (0, False)
    register.clear(0x8250, 1)
    assert len(sent) == 2


def test_the_register_has_the_bits_of_all_that_are_active(errors: Any) -> None:
    register, image, sent = errors
    register.report(0x8611, PROFILE_ERROR)
    register.report(0x8130, COMMUNICATION_ERROR, "node guarding")
    register.report(0x2310, 1 << 1)
    assert [word for _, word, _ in sent] == [0x21, 0x31, 0x33]
    register.clear(0x8611)
    assert (sent[-1], image.error_register) == ((0, 0x13, 0), 0x13)
    register.clear(0x2310)
    assert (sent[-1], image.error_register) == ((0, 0x11, 0), 0x11)


def test_what_is_over_already_is_reported_beside_what_stands(errors: Any) -> None:
    register, image, sent = errors
    register.mention(0x8140, COMMUNICATION_ERROR)
    assert (sent, image.error_register) == ([(0x8140, 0x11, 0)], 0)
    register.report(0x8611, PROFILE_ERROR)
    register.mention(0x8140, COMMUNICATION_ERROR)
    assert sent[-1] == (0x8140, GENERIC | PROFILE_ERROR | COMMUNICATION_ERROR, 0)
    assert (image.error_register, register.is_active(0x8140)) == (0x21, False)


@pytest.mark.parametrize("source", [0, "bus"])
def test_resets_forget_without_a_message(errors: Any, source: object) -> None:
    """That of the communication leaves what the application has; one of the node leaves nothing."""
    register, image, sent = errors
    for _ in range(2):
        register.report(0x8611, PROFILE_ERROR)
        register.report(0x8120, COMMUNICATION_ERROR, source)
        sent.clear()
        register.forget_communication()
        assert (sent, image.error_register) == ([], 0x21)
        assert (register.is_active(0x8611), register.is_active(0x8120)) == (True, False)
        register.forget()
        assert (sent, image.error_register, register.is_active(0x8611)) == ([], 0, False)


@pytest.mark.parametrize(
    ("option", "state", "sent"),
    [
        (0, State.OPERATION_ENABLED, []),
        (1, State.FAULT_REACTION_ACTIVE, [(0x8130, 0x11, 0)]),
        (2, State.SWITCH_ON_DISABLED, []),
        (3, State.QUICK_STOP_ACTIVE, []),
    ],
)
def test_a_lost_connection_does_what_6007_says(
    fake_axis: Any, option: int, state: State, sent: list[Any]
) -> None:
    """CiA 402-2, 6007: nothing, fault, disable voltage, quick stop; the axis moves at 0.1 m/s."""
    one = ServoAlone(fake_axis(), 9, abort_option=option, target_velocity=0.1 * PER_M)
    one.cycle()
    one.cycle()
    before = one.changes
    one.servo.connection_lost(one.now_ns)
    assert (one.servo.state, one.sent) == (state, sent)
    assert one.axis.commands[-1].enabled is (option != 2)
    assert one.changes == before + (option in (2, 3))
    own_code = ServoAlone(fake_axis(), 9, abort_option=option)
    own_code.servo.connection_lost(own_code.now_ns, 0x8700)
    assert own_code.sent == [(0x8700, 0x11, 0)] * len(sent)
