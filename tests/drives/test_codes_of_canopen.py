"""Codes and identifiers of CANopen as the standards print them: CiA 301, CiA 305, CiA 402-1."""

import pytest

from axisrig.kernel.drives.cia402.objects import SdoError
from axisrig.kernel.profiles.canopen import identifiers, nmt
from axisrig.kernel.profiles.canopen.aborts import abort_text
from axisrig.kernel.profiles.canopen.emergency import Emergency, codes, meaning_of, row_of
from axisrig.kernel.profiles.cia402.ds402 import COMMANDS, STATES, Command, State


@pytest.mark.parametrize(
    ("code", "reaction", "meaning"),
    [
        (0x0000, "none", "error reset or no error"),
        (0x1000, "stop", "generic error"),
        (0x1FFF, "stop", "generic error"),
        (0x2110, "stop", "short circuit or earth leakage at the input"),
        (0x211F, "stop", "short circuit or earth leakage at the input"),
        (0x2120, "stop", "current"),
        (0x2311, "stop", "current"),
        (0x3210, "stop", "DC link over-voltage"),
        (0x5530, "stop", "non-volatile memory"),
        (0x8110, "warn", "CAN overrun: messages were lost"),
        (0x8111, "stop", "communication"),
        (0x8120, "warn", "CAN controller is error passive"),
        (0x8130, "stop", "life guarding or heartbeat of the master was lost"),
        (0x8299, "stop", "protocol"),
        (0x8611, "stop", "following error"),
        (0x8699, "stop", "positioning"),
        (0xF123, "stop", "additional functions"),
        (0xFF00, "stop", "code of the manufacturer"),
        (0xFFFF, "stop", "code of the manufacturer"),
        (0x0001, "stop", "a code that is not in the table"),
        (0x8800, "stop", "a code that is not in the table"),
    ],
)
def test_an_exact_code_comes_before_its_class_and_an_unknown_one_stops(
    code: int, reaction: str, meaning: str
) -> None:
    emergency = Emergency(code, 0x21, b"")
    assert (emergency.reaction, meaning_of(code)) == (reaction, meaning)
    assert (row_of(code) is None) is ("not in the table" in meaning)
    assert str(emergency) == f"0x{code:04X}, {meaning}, error register 0x21"


def test_no_row_of_the_emergencies_is_hidden_by_another_one() -> None:
    for row in codes():
        assert row_of(row.code) is row
        assert row.code & row.mask == row.code


@pytest.mark.parametrize(
    ("data", "code", "register", "vendor"),
    [
        ("1186052122232425", 0x8611, 0x05, "2122232425"),
        ("118605", 0x8611, 0x05, "0000000000"),
        ("11", 0x0011, 0, "0000000000"),
        ("", 0, 0, "0000000000"),
    ],
)
def test_an_emergency_is_code_register_and_five_bytes(
    data: str, code: int, register: int, vendor: str
) -> None:
    assert Emergency.read(bytes.fromhex(data)) == Emergency(code, register, bytes.fromhex(vendor))


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (0x05030000, "abort 0x05030000, toggle bit not alternated"),
        (0x06020000, "abort 0x06020000, object does not exist"),
        (0x06090011, "abort 0x06090011, sub-index does not exist"),
        (0x08000022, "abort 0x08000022, data cannot be transferred or stored in the present state"
                     " of the device"),
        (0xDEADBEEF, "abort 0xDEADBEEF, a code of the manufacturer"),
    ],
)  # fmt: skip
def test_an_abort_is_reported_in_words(code: int, words: str) -> None:
    assert abort_text(code) == words


@pytest.mark.parametrize(
    ("code", "words"), [(None, "no answer"), (0, "abort 0x00000000"), (0x0602_0000, "not exist")]
)
def test_an_access_without_an_answer_is_not_one_with_the_code_0(
    code: int | None, words: str
) -> None:
    error = SdoError(0x60D0, 10, code)
    assert (error.target, error.code) == ("0x60D0:A", code)
    assert words in str(error)


def test_identifiers_are_those_of_the_pre_defined_connection_set() -> None:
    assert (identifiers.NMT_ID, identifiers.SYNC_ID, identifiers.EMERGENCY_BASE) == (0, 0x80, 0x80)
    assert (identifiers.SDO_ANSWER_BASE, identifiers.SDO_REQUEST_BASE) == (0x580, 0x600)
    assert identifiers.ERROR_CONTROL_BASE == 0x700
    assert (identifiers.LSS_ANSWER_ID, identifiers.LSS_REQUEST_ID) == (0x7E4, 0x7E5)
    assert {
        f"{way}PDO{number}": base + 0x100 * (number - 1)
        for way, base in (("T", 0x180), ("R", 0x200))
        for number in (1, 2, 3, 4)
    } == identifiers.PDO_BASE
    assert (nmt.START, nmt.STOP, nmt.ENTER_PRE_OPERATIONAL, nmt.RESET_NODE) == (1, 2, 128, 129)
    assert (nmt.RESET_COMMUNICATION, nmt.BOOT_UP, nmt.PRE_OPERATIONAL) == (130, 0, 127)
    assert (nmt.STOPPED, nmt.OPERATIONAL) == (4, 5)


@pytest.mark.parametrize(
    ("can_id", "service"),
    [
        (0x000, "NMT"), (0x001, None), (0x07F, None), (0x080, "SYNC"), (0x081, "EMCY"),
        (0x0FF, "EMCY"), (0x100, "TIME"), (0x101, None), (0x180, None), (0x181, "TPDO1"),
        (0x1FF, "TPDO1"), (0x200, None), (0x27F, "RPDO1"), (0x57F, "RPDO4"), (0x580, None),
        (0x581, "SDO answer"), (0x5FF, "SDO answer"), (0x601, "SDO request"), (0x680, None),
        (0x701, "heartbeat"), (0x77F, "heartbeat"), (0x7E3, None), (0x7E4, "LSS answer"),
        (0x7E5, "LSS request"), (0x7FF, None),
    ],
)  # fmt: skip
def test_an_identifier_has_one_service_at_most(can_id: int, service: str | None) -> None:
    found = identifiers.service_of(can_id)
    assert (found and found.name) == service
    assert sum(s.first <= can_id <= s.last for s in identifiers.services()) == bool(service)


@pytest.mark.parametrize(
    ("can_id", "is_restricted"),
    [(0x001, True), (0x07F, True), (0x080, False), (0x100, False), (0x101, True), (0x180, True),
     (0x181, False), (0x580, False), (0x581, True), (0x5FF, True), (0x600, False), (0x601, True),
     (0x67F, True), (0x680, False), (0x6DF, False), (0x6E0, True), (0x6FF, True), (0x700, False),
     (0x701, True), (0x77F, True), (0x7FF, True), (0x000, True)],
)  # fmt: skip
def test_some_identifiers_are_taken_by_no_cob_id(can_id: int, is_restricted: bool) -> None:
    assert any(can_id in found for found in identifiers.RESTRICTED) is is_restricted


@pytest.mark.parametrize("word", range(0x80))
def test_a_statusword_is_one_state_at_most(word: int) -> None:
    """CiA 402-2, table of the states: bits 6, 5, 3, 2, 1 and 0."""
    found = [state for state, row in STATES.items() if word & row.mask == row.value]
    bits = f"{word & 0x6F:07b}"
    printed = {
        State.NOT_READY_TO_SWITCH_ON: "0x00000", State.SWITCH_ON_DISABLED: "1x00000",
        State.READY_TO_SWITCH_ON: "0100001", State.SWITCHED_ON: "0100011",
        State.OPERATION_ENABLED: "0100111", State.QUICK_STOP_ACTIVE: "0000111",
        State.FAULT_REACTION_ACTIVE: "0x01111", State.FAULT: "0x01000",
    }  # fmt: skip
    assert found == [
        state
        for state, pattern in printed.items()
        if all(p in ("x", bit) for p, bit in zip(pattern, bits, strict=True))
    ]


@pytest.mark.parametrize(
    ("word", "commands"),
    [
        (0x06, {Command.SHUTDOWN}), (0x0E, {Command.SHUTDOWN}), (0x07, {Command.SWITCH_ON}),
        (0x0F, {Command.ENABLE_OPERATION}), (0x1F, {Command.ENABLE_OPERATION}),
        (0x00, {Command.DISABLE_VOLTAGE}), (0x0D, {Command.DISABLE_VOLTAGE}),
        (0x02, {Command.QUICK_STOP}), (0x0B, {Command.QUICK_STOP}), (0x80, {Command.FAULT_RESET}),
        (0x8F, {Command.FAULT_RESET}),
    ],
)  # fmt: skip
def test_a_controlword_is_one_command(word: int, commands: set[Command]) -> None:
    found = {command for command, row in COMMANDS.items() if word & row.mask == row.value}
    assert found == commands
    assert [command for command, row in COMMANDS.items() if row.rising] == [Command.FAULT_RESET]
