"""Telegrams of a SERCOS drive with more than one thing wrong, or more than one bit held."""

import pytest
from tests.sercos.test_sercos_faults_by_hand import BIT_1, BIT_2, Hand

from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.profiles.sercos.service import ident_number, pack_list

TYPE = ident_number("S-0-0015")
BITS = {"CONTROL_1": BIT_1, "CONTROL_2": BIT_2, "STATUS_1": BIT_1, "STATUS_2": BIT_2}


def _listed(hand: Hand, ident: str, *items: str) -> None:
    numbers = [ident_number(item) for item in items]
    assert hand.written(ident, pack_list(numbers, 2, len(numbers))) is None


def _hand(profile: str = "one_probe") -> Hand:
    hand = Hand(profile=profile)
    hand.drive.states.state = AlState.PREOP
    return hand


def test_all_that_is_wrong_is_named_the_type_first_then_the_lists() -> None:
    """A master that mends one thing after the other would need as many checks."""
    hand = _hand()
    _listed(hand, "S-0-0016", "S-0-0047", "S-0-0051")
    _listed(hand, "S-0-0024", "S-0-0051")
    at, mdt = ident_number("S-0-0047"), ident_number("S-0-0051")
    assert hand.drive.telegrams.wrong() == [at, mdt]
    hand.drive.idents.put(TYPE, 4)
    assert hand.drive.telegrams.wrong() == [TYPE, at, mdt]
    # The AL status says the outputs while the type is wrong, whatever the AT has
    assert hand.drive.enter(AlState.SAFEOP) == "INVALID_OUTPUT_MAPPING"
    hand.drive.idents.put(TYPE, 7)
    assert hand.drive.enter(AlState.SAFEOP) == "INVALID_INPUT_MAPPING"
    _listed(hand, "S-0-0016", "S-0-0051")
    assert hand.drive.telegrams.wrong() == [mdt]
    assert hand.drive.enter(AlState.SAFEOP) == "INVALID_OUTPUT_MAPPING"


@pytest.mark.parametrize("ident", ["S-0-0132", "S-0-0133"])
def test_a_value_of_probe_2_is_carried_where_the_drive_has_one(ident: str) -> None:
    for profile, wrong in (("two_probes", []), ("one_probe", [ident_number(ident)])):
        hand = _hand(profile)
        _listed(hand, "S-0-0016", "S-0-0051", ident)
        assert hand.drive.telegrams.wrong() == wrong


@pytest.mark.parametrize("word", ["CONTROL", "STATUS"])
@pytest.mark.parametrize("levels", [(True, True), (True, False), (False, True), (False, False)])
def test_two_bits_of_a_word_are_held_and_set_free_each_for_itself(
    word: str, levels: tuple[bool, bool]
) -> None:
    """Those of the other word pass all the time."""
    hand = Hand()
    telegrams = hand.drive.telegrams
    names = [f"{word}_{number}" for number in (1, 2)]
    for name, level in zip(names, levels, strict=True):
        telegrams.hold(name, level=level)
    held = sum(BITS[name] for name, level in zip(names, levels, strict=True) if level)
    own = (telegrams.control_held, telegrams.control_passes)
    other = (telegrams.status_held, telegrams.status_passes)
    if word == "STATUS":
        own, other = other, own
    assert own == (held, 0xFFFF & ~(BIT_1 | BIT_2))
    assert other == (0, 0xFFFF)
    telegrams.hold(names[0], level=None)
    own = (telegrams.control_held, telegrams.control_passes)
    if word == "STATUS":
        own = (telegrams.status_held, telegrams.status_passes)
    assert own == (BIT_2 if levels[1] else 0, 0xFFFF & ~BIT_2)


def test_a_control_bit_that_is_held_acts_beside_one_that_passes() -> None:
    """S-0-0134 of the drive: bit 6 up, bit 7 down, whatever the master sends; then both free."""
    hand = Hand()
    hand.drive.hold_bit("CONTROL_1", level=True)
    hand.drive.hold_bit("CONTROL_2", level=False)
    for sent in (0, BIT_1, BIT_2, BIT_1 | BIT_2):
        hand.cycle(sent)
        assert hand.number("S-0-0134") == BIT_1
    for name in ("CONTROL_1", "CONTROL_2"):
        hand.drive.hold_bit(name, level=None)
    for sent in (0, BIT_1, BIT_2, BIT_1 | BIT_2):
        hand.cycle(sent)
        assert hand.number("S-0-0134") == sent
