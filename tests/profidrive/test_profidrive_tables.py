"""Tables of PROFIdrive drives: each state with each input, telegrams, words."""

import csv
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.profidrive import front, tables
from axisrig.bench.drive.profidrive.encoder import EncoderInterface
from axisrig.bench.drive.profidrive.life import SignOfLife
from axisrig.bench.rig.profidrive.keys import DriveTable
from axisrig.kernel.drives.profidrive import link
from axisrig.kernel.profiles.cia402.ds402 import ProbeStatus, State
from axisrig.kernel.profiles.profidrive import words

HERE = Path(tables.__file__).parent
F, V = tables.FunctionState, tables.FunctionInput
ACTIVATE, READ, ABORT = (
    code << words.COMMAND_SHIFT for code in (words.ACTIVATE, words.READ, words.ABORT)
)
POS, NEG = words.FUNCTION_OF[1, "POS"], words.FUNCTION_OF[1, "NEG"]
FLYING = words.FLYING


@pytest.mark.parametrize(
    ("name", "states", "inputs"),
    [
        ("power", tables.PowerState, tables.PowerInput),
        ("functions", tables.FunctionState, tables.FunctionInput),
        ("interface", tables.InterfaceState, tables.InterfaceInput),
    ],
)
def test_each_state_has_each_input_once(name: str, states: type, inputs: type) -> None:
    text = (HERE / f"{name}.csv").read_text(encoding="utf-8")
    rows = [(row["state"], row["input"]) for row in csv.DictReader(text.splitlines())]
    expected = [(state.name, asked.name) for state in states for asked in inputs]  # type: ignore[attr-defined]
    assert sorted(rows) == sorted(expected)


@pytest.mark.parametrize("state", tables.PowerState)
@pytest.mark.parametrize("asked", tables.PowerInput)
def test_power_is_never_given_by_what_takes_it_away(
    state: tables.PowerState, asked: tables.PowerInput
) -> None:
    """OFF2 takes the torque in each state; only HALT and OPERATE keep an axis in operation."""
    command = tables.COMMANDS[state, asked]
    assert command in front.CONTROLWORD
    if asked is tables.PowerInput.OFF2 or state is tables.PowerState.FAULT:
        assert command == "DISABLE"
    may_move = asked in (tables.PowerInput.HALT, tables.PowerInput.OPERATE)
    has_power = state in (tables.PowerState.ON, tables.PowerState.OPERATION)
    assert (command in ("OPERATE", "HALT")) is (may_move and has_power)
    if state is tables.PowerState.INHIBITED:  # it wants to see OFF first
        assert (command == "SHUTDOWN") is (asked is tables.PowerInput.OFF)


@pytest.mark.parametrize(
    ("word", "asked"),
    [
        (0x047F, "OPERATE"),
        (0x043F, "HALT"),
        (0x046F, "HALT"),
        (0x045F, "HALT"),
        (0x0477, "INHIBIT"),
        (0x047E, "OFF"),
        (0x047B, "OFF3"),
        (0x047D, "OFF2"),
        (0x0000, "OFF2"),
    ],
)
def test_control_word_1_asks_for_the_first_that_holds(word: int, asked: str) -> None:
    assert front.asked(word).name == asked


@pytest.mark.parametrize("state", State)
def test_an_acknowledgement_says_something_in_a_fault_alone(state: State) -> None:
    """STW1 bit 7; whatever else the word asks for."""
    servo: Any = SimpleNamespace(state=state)
    for word in (0x047F, 0x043F, 0x0477, 0x047E, 0x047B, 0x0000):
        with_it = front.controlword(servo, word | 1 << 7)
        assert with_it == (0x80 if state is State.FAULT else front.controlword(servo, word))


def test_words_of_the_control_are_those_of_the_field() -> None:
    """047E and 047F as everywhere with SINAMICS drives."""
    assert (link.OFF, link.MOVING, link.HALTED) == (0x047E, 0x047F, 0x043F)


@pytest.mark.parametrize(
    ("number", "to_drive", "from_drive"),
    [(3, 10, 18), (4, 12, 28), (5, 18, 18), (6, 20, 28), (105, 20, 20)],
)
def test_telegrams_have_their_lengths(number: int, to_drive: int, from_drive: int) -> None:
    """Bytes: 5 and 9 words of telegram 3; XERR and KPC are 2 words each, telegram 105 has 10."""
    telegram = words.telegrams()[number]
    assert words.codec_of(telegram.to_drive).size == to_drive
    assert words.codec_of(telegram.from_drive).size == from_drive
    assert telegram.has_dsc is (number in (5, 6, 105))
    assert telegram.has_second is (number in (4, 6))


def test_words_are_big_endian() -> None:
    codec = words.codec_of(("STW1", "NSOLL_B"))
    assert codec.pack(0x047F, -2) == bytes.fromhex("047ffffffffe")


def test_2048_lines_with_11_fine_bits_are_2_384_nm() -> None:
    """10 mm / 2^22."""
    table = DriveTable.model_validate({"family": "profidrive", "lead_mm": 10.0})
    assert table.facts().units_per_mm == Fraction(1 << 22, 10)
    assert "2.384 nm" in table.in_words


def test_speeds_are_shares_of_the_base_speed() -> None:
    """16 384 rpm are 2^30, so that 1 rpm is 65 536: 10 mm in a minute."""
    made = DriveTable.model_validate({"family": "profidrive", "lead_mm": 10.0}).make()
    assert 65_536 * made.speed_m_s == Fraction(1, 100) / 60


# The sign of life


def counted(values: list[int], limit: int = 1) -> tuple[list[int], list[bool]]:
    life, counters, lost = SignOfLife(lambda: limit), [], []
    for value in values:
        life.take(value)
        counters.append(life.counter)
        lost.append(life.is_lost)
    return counters, lost


def test_a_stuck_sign_of_life_is_a_fault_in_the_second_wrong_cycle() -> None:
    """P0925 = 1: 10 is not above 10, 20 is."""
    assert counted([1, 2, 2, 2]) == ([0, 0, 10, 20], [False, False, False, True])
    assert counted([1, 2, 2, 2, 2], limit=2)[1] == [False, False, False, False, True]


def test_right_signs_count_down_and_not_below_0() -> None:
    right = [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 1]
    assert counted([1, 1, *right])[0] == [0, 10, *range(9, -1, -1), 0, 0, 0, 0]


def test_none_counts_before_the_first_sign_of_life() -> None:
    assert counted([0, 0, 0, 5, 6])[0] == [0, 0, 0, 0, 0]


def test_a_lost_telegram_is_one_wrong_sign_and_two_of_three_are_a_fault() -> None:
    assert counted([1, 2, 2, 4, 5])[0] == [0, 0, 10, 9, 8]
    assert counted([1, 2, 2, 4, 4]) == ([0, 0, 10, 9, 19], [*[False] * 4, True])


# The encoder interface


class Probe:
    """The touch probe unit as the interface sees it."""

    def __init__(self) -> None:
        self.status = self.inputs = 0


@pytest.fixture
def probe() -> Probe:
    return Probe()


@pytest.fixture
def interface(probe: Probe) -> EncoderInterface:
    return EncoderInterface(probe, has_input=lambda: True)


def test_a_value_is_shown_by_the_command_to_read_alone(
    interface: EncoderInterface, probe: Probe
) -> None:
    interface.command(POS | ACTIVATE | FLYING)
    assert (interface.status(), interface.value(7)) == (POS, 0)
    probe.status = int(ProbeStatus.POSITIVE_STORED_1)
    interface.take_edges((1234, 0))
    assert (interface.status(), interface.value(7)) == (POS << 4, 0)
    interface.command(POS | READ | FLYING)
    assert (interface.status(), interface.value(7)) == (POS << 4, 1234)
    interface.command(0)
    assert (interface.status(), interface.value(7)) == (0, 0)


def test_with_both_edges_no_value_before_the_second_function_has_ended(
    interface: EncoderInterface, probe: Probe
) -> None:
    interface.command(POS | NEG | ACTIVATE | FLYING)
    probe.status = int(ProbeStatus.POSITIVE_STORED_1)
    interface.take_edges((11, 0))
    interface.command(POS | READ | FLYING)
    assert (interface.status(), interface.value(7)) == (NEG | POS << 4, 0)
    probe.status |= int(ProbeStatus.NEGATIVE_STORED_1)
    interface.take_edges((11, 22))
    interface.command(POS | NEG | READ | FLYING)
    assert interface.value(7) == 11
    interface.command(NEG | READ | FLYING)
    assert (interface.status(), interface.value(7)) == (NEG << 4, 22)


@pytest.mark.parametrize(
    ("word", "code"),
    [
        (words.FUNCTION_OF[2, "POS"] | ACTIVATE | FLYING, 6),
        (words.FUNCTION_OF[2, "NEG"] | ACTIVATE | FLYING, 6),
        (POS | ACTIVATE | FLYING | words.ABSOLUTE, 6),
        (POS | ACTIVATE | FLYING | words.PARK, 6),
        (POS | ACTIVATE, 4),
    ],
)
def test_what_cannot_be_done_is_an_error_code_until_it_is_acknowledged(
    interface: EncoderInterface, word: int, code: int
) -> None:
    interface.command(word)
    assert (interface.status(), interface.value(7)) == (words.ENCODER_ERROR, code)
    interface.command(0)
    assert interface.value(7) == code
    interface.command(words.ENCODER_ACKNOWLEDGE)
    assert (interface.status(), interface.value(7)) == (words.ACKNOWLEDGING, 0)
    interface.command(0)
    assert interface.status() == 0


@pytest.mark.parametrize("word", [words.ABSOLUTE, words.PARK])
def test_absolute_position_and_parking_break_a_measurement_off(
    interface: EncoderInterface, word: int
) -> None:
    interface.command(POS | ACTIVATE | FLYING)
    interface.command(word)
    assert (interface.status(), interface.value(7)) == (words.ENCODER_ERROR, 6)
    assert interface.function() == 0


def test_the_absolute_position_is_there_while_it_is_asked_for(interface: EncoderInterface) -> None:
    interface.command(words.ABSOLUTE)
    assert (interface.status(), interface.value(7)) == (words.ABSOLUTE, 7)
    interface.command(0)
    assert (interface.status(), interface.value(7)) == (0, 0)


def test_abort_drops_function_and_value(interface: EncoderInterface, probe: Probe) -> None:
    interface.command(POS | ACTIVATE | FLYING)
    interface.command(POS | ABORT | FLYING)
    assert (interface.status(), interface.function()) == (0, 0)
    interface.command(POS | ACTIVATE | FLYING)
    probe.status = int(ProbeStatus.POSITIVE_STORED_1)
    interface.take_edges((5, 0))
    interface.command(POS | ABORT | FLYING)
    assert interface.status() == 0


def test_without_p0660_a_function_waits_for_ever(probe: Probe) -> None:
    interface = EncoderInterface(probe, has_input=lambda: False)
    probe.inputs = 1
    interface.command(POS | ACTIVATE | FLYING)
    assert (interface.status(), interface.function()) == (POS, 0)


@pytest.mark.parametrize("code", [1, 6])
def test_a_fault_of_the_encoder_ends_what_waits_until_it_is_acknowledged(
    interface: EncoderInterface, probe: Probe, code: int
) -> None:
    """While it waits, has a value, shows it; an edge of meanwhile is none. Then as ever."""
    for stage in range(3):
        interface.command(POS | NEG | ACTIVATE | FLYING)
        if stage:
            probe.status = int(ProbeStatus.POSITIVE_STORED_1 | ProbeStatus.NEGATIVE_STORED_1)
            interface.take_edges((11, 22))
        if stage == 2:
            interface.command(POS | READ | FLYING)
            assert interface.value(7) == 11
        interface.break_off(code)
        interface.take_edges((33, 44))
        assert (interface.status(), interface.value(7)) == (words.ENCODER_ERROR, code)
        assert interface.function() == 0
        interface.command(POS | ACTIVATE | FLYING)
        assert (interface.status(), interface.value(7)) == (words.ENCODER_ERROR, code)
        interface.command(words.ENCODER_ACKNOWLEDGE)
        interface.command(0)
        assert (interface.status(), interface.value(7)) == (0, 0)
        probe.status = 0
