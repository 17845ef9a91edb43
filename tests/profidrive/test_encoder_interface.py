"""The encoder interface over several cycles: both functions at once, what is held, what is over."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.profidrive.encoder import EncoderInterface
from axisrig.kernel.profiles.cia402.ds402 import ProbeFunction, ProbeStatus
from axisrig.kernel.profiles.profidrive import words

POS, NEG = words.FUNCTION_OF[1, "POS"], words.FUNCTION_OF[1, "NEG"]
BOTH = POS | NEG
ACTIVATE, READ, ABORT = (
    command << words.COMMAND_SHIFT | words.FLYING
    for command in (words.ACTIVATE, words.READ, words.ABORT)
)
STORED = {POS: int(ProbeStatus.POSITIVE_STORED_1), NEG: int(ProbeStatus.NEGATIVE_STORED_1)}
EDGE = {POS: int(ProbeFunction.POSITIVE_1), NEG: int(ProbeFunction.NEGATIVE_1)}
ENABLE = int(ProbeFunction.ENABLE_1)


class Encoder:
    """The interface, with a touch probe unit whose status words are set by hand."""

    def __init__(self) -> None:
        self.probe: Any = SimpleNamespace(status=0, inputs=0)
        self.has_input = True
        self.interface = EncoderInterface(self.probe, has_input=lambda: self.has_input)

    def give(self, word: int) -> tuple[int, int]:
        """Give a control word; return status and value (99: the absolute position)."""
        self.interface.command(word)
        return self.interface.status(), self.interface.value(99)

    def store(self, functions: int) -> None:
        self.probe.status = sum(bit for function, bit in STORED.items() if function & functions)
        self.interface.take_edges((11, 22))


@pytest.fixture
def far() -> Encoder:
    return Encoder()


def test_of_two_values_that_are_read_at_once_one_is_shown(far: Encoder) -> None:
    """The first one; the other when the first is read no more."""
    assert far.give(BOTH | ACTIVATE) == (BOTH, 0)
    assert far.interface.function() == ENABLE | EDGE[POS] | EDGE[NEG]
    far.store(BOTH)
    assert far.interface.function() == 0
    for _ in range(2):
        assert far.give(BOTH | READ) == (BOTH << 4, 11)
    assert far.give(POS | READ) == (BOTH << 4, 11)
    # The first ends in the cycle in which the second is asked for alone
    assert far.give(NEG | READ) == (NEG << 4, 22)
    assert far.give(NEG | READ) == (NEG << 4, 22)
    assert far.give(0) == (0, 0)


@pytest.mark.parametrize(("first", "value"), [(POS, 11), (NEG, 22)])
def test_a_value_waits_until_no_function_does(far: Encoder, first: int, value: int) -> None:
    far.give(BOTH | ACTIVATE)
    far.store(first)
    other = BOTH & ~first
    assert far.interface.function() == ENABLE | EDGE[other]
    assert far.give(first | READ) == (first << 4 | other, 0)
    assert far.give(other | ABORT) == (first << 4, 0)
    assert far.give(first | READ) == (first << 4, value)
    assert far.give(first | ABORT) == (0, 0)


def test_an_error_stays_while_it_is_acknowledged_and_is_gone_with_the_bit(far: Encoder) -> None:
    """The bit may be held; its edge counts, so that one held since before acknowledges nothing."""
    acknowledge = words.ENCODER_ACKNOWLEDGE
    far.give(acknowledge)
    wrong = POS | words.ACTIVATE << words.COMMAND_SHIFT  # of a reference mark
    assert far.give(acknowledge | wrong) == (words.ENCODER_ERROR, 4)
    assert far.give(acknowledge) == (words.ENCODER_ERROR, 4)
    assert far.give(0) == (words.ENCODER_ERROR, 4)
    for _ in range(3):
        assert far.give(acknowledge) == (words.ACKNOWLEDGING, 0)
    assert far.give(0) == (0, 0)
    assert far.give(POS | ACTIVATE) == (POS, 0)


@pytest.mark.parametrize("word", [words.ABSOLUTE, words.PARK])
@pytest.mark.parametrize("functions", [POS, NEG, BOTH])
def test_whatever_waits_is_ended_by_another_wish(far: Encoder, word: int, functions: int) -> None:
    far.give(functions | ACTIVATE)
    assert far.give(word) == (words.ENCODER_ERROR, 6)
    assert far.interface.function() == 0
    far.store(BOTH)
    assert far.give(functions | READ) == (words.ENCODER_ERROR, 6)
    far.give(words.ENCODER_ACKNOWLEDGE)
    shown = (words.ABSOLUTE, 99) if word == words.ABSOLUTE else (words.PARK, 0)
    assert far.give(word) == shown
    assert far.give(0) == (0, 0)


def test_a_function_that_nobody_asked_for_holds_the_values_of_the_other(far: Encoder) -> None:
    far.interface.holds_other = True
    assert far.give(POS | ACTIVATE) == (BOTH, 0)
    far.store(POS)
    assert far.give(POS | READ) == (POS << 4 | NEG, 0)
    far.interface.holds_other = False
    assert far.give(POS | READ) == (POS << 4, 11)


def test_the_level_is_that_of_the_input_where_the_probe_has_it(far: Encoder) -> None:
    for has_input, inputs, shown in ((True, 1, True), (True, 2, False), (False, 1, False)):
        far.has_input, far.probe.inputs = has_input, inputs
        assert bool(far.give(0)[0] & words.DEFLECTED[0]) is shown
    far.give(POS | ACTIVATE)
    assert far.interface.function() == 0  # without the input


def test_power_and_a_fault_end_functions_and_errors(far: Encoder) -> None:
    far.give(BOTH | ACTIVATE)
    far.interface.break_off(3)
    assert far.give(0) == (words.ENCODER_ERROR, 3)
    far.interface.reset()
    assert far.give(0) == (0, 0)
    # An acknowledge that is there with the power is an edge
    far.interface.break_off(3)
    assert far.give(words.ENCODER_ACKNOWLEDGE) == (words.ACKNOWLEDGING, 0)
    far.interface.reset()
    far.interface.break_off(3)
    assert far.give(words.ENCODER_ACKNOWLEDGE) == (words.ACKNOWLEDGING, 0)
