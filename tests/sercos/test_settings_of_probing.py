"""What a master sets of the probing of a SERCOS drive, and what is refused, by hand.

AX5000 ident descriptions: S-0-0169 selects edges, S-0-0170 begins the cycle, S-0-0301 to 307
assign real-time bits; `profiles.csv` has where two drives differ.
"""

import pytest
from tests.sercos.test_sercos_faults_by_hand import BIT_1, BIT_2, C1D, FOLLOW, Hand

from axisrig.kernel.profiles.cia402.ds402 import ProbeFunction
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.profiles.sercos.service import ident_number, pack_list

BITS = {"S-0-0301": BIT_1, "S-0-0303": BIT_2, "S-0-0305": BIT_1, "S-0-0307": BIT_2}
CONTROL, STATUS = ("S-0-0301", "S-0-0303"), ("S-0-0305", "S-0-0307")
SELECT, COMMAND = "S-0-0169", "S-0-0170"
WAITS = "WAITS"
"""For the first outputs: nothing is refused."""


def word(number: int) -> bytes:
    return number.to_bytes(2, "little")


def named(name: str) -> bytes:
    return word(ident_number(name))


def in_phase(number: int, profile: str = "one_probe") -> Hand:
    hand = Hand(profile=profile)
    hand.drive.states.state = AlState.PREOP if number == 2 else AlState.SAFEOP
    return hand


@pytest.mark.parametrize("allocation", BITS)
@pytest.mark.parametrize(
    ("profile", "ident", "of_control", "of_status"),
    [
        ("one_probe", "S-0-0405", None, None),
        ("one_probe", "S-0-0169", None, None),  # any that it has
        ("one_probe", "S-0-0406", "INVALID", "INVALID"),  # the second probe it has not
        ("one_probe", "S-0-0104", "INVALID", "INVALID"),
        ("two_probes", "S-0-0405", None, "INVALID"),
        ("two_probes", "S-0-0406", None, "INVALID"),
        ("two_probes", "S-0-0409", "INVALID", None),
        ("two_probes", "S-0-0412", "INVALID", None),
        ("two_probes", "S-0-0400", "INVALID", None),
        ("two_probes", "S-0-0336", "INVALID", "INVALID"),  # in its list, and it has not got it
        ("two_probes", "S-0-0401", "INVALID", "INVALID"),
    ],
)
def test_a_real_time_bit_takes_what_the_drive_can_assign_to_it(
    allocation: str, profile: str, ident: str, of_control: str | None, of_status: str | None
) -> None:
    """0 takes the assignment back, always."""
    hand = in_phase(2, profile)
    expected = of_control if allocation in CONTROL else of_status
    assert hand.number(allocation) == 0
    assert hand.written(allocation, named(ident)) == expected
    assert hand.number(allocation) == (0 if expected else ident_number(ident))
    assert hand.written(allocation, word(0)) is None
    assert hand.number(allocation) == 0


@pytest.mark.parametrize(("profile", "bits"), [("one_probe", 0x0123), ("two_probes", 0x000F)])
def test_s_0_0169_takes_the_bits_that_the_drive_has(profile: str, bits: int) -> None:
    hand = in_phase(2, profile)
    for bit in range(16):
        found = hand.written(SELECT, word(1 << bit))
        assert found == (None if bits >> bit & 1 else "INVALID"), bit
    assert hand.written(SELECT, word(bits)) is None
    assert hand.number(SELECT) == bits
    assert hand.written(SELECT, word(0xFFFF)) == "INVALID"
    assert hand.number(SELECT) == bits
    assert hand.written(SELECT, word(0)) is None


@pytest.mark.parametrize(
    ("profile", "code"), [("one_probe", "PROTECTED_NOW"), ("two_probes", None)]
)
def test_the_selection_is_locked_while_the_probing_cycle_runs_where_the_drive_does_so(
    profile: str, code: str | None
) -> None:
    """On, off, on."""
    hand = in_phase(3, profile)
    for _ in range(2):
        assert hand.written(SELECT, word(1)) is None
        assert hand.written(COMMAND, word(3)) is None
        assert hand.state(COMMAND) == "RUNNING"
        assert hand.written(SELECT, word(2)) == code
        assert hand.number(SELECT) == (1 if code else 2)
        assert hand.written(COMMAND, word(0)) is None
        assert hand.state(COMMAND) == "IDLE"
    assert hand.written(SELECT, word(2)) is None


@pytest.mark.parametrize(("profile", "state"), [("one_probe", "RUNNING"), ("two_probes", "FAILED")])
def test_a_probing_cycle_without_an_edge_begins_where_the_drive_needs_none(
    profile: str, state: str
) -> None:
    hand = in_phase(3, profile)
    assert hand.written(SELECT, word(0)) is None
    hand.written(COMMAND, word(3))
    assert hand.state(COMMAND) == state
    assert hand.drive.probing.is_running is (state == "RUNNING")


@pytest.mark.parametrize("allocation", CONTROL)
def test_a_real_time_bit_that_has_s_0_0170_begins_and_ends_the_cycle(allocation: str) -> None:
    """Each time that it changes; the other bit does nothing."""
    hand = Hand()
    assert hand.written(SELECT, word(1)) is None
    assert hand.written(allocation, named(COMMAND)) is None
    mine, other = BITS[allocation], (BIT_1 | BIT_2) & ~BITS[allocation]
    for control, state in (
        (0, "IDLE"), (other, "IDLE"), (mine, "RUNNING"), (mine, "RUNNING"), (other, "IDLE"),
        (mine | other, "RUNNING"), (0, "IDLE"),
    ):  # fmt: skip
        hand.cycle(control)
        assert (hand.state(COMMAND), hand.drive.probing.is_running) == (state, state == "RUNNING")


@pytest.mark.parametrize("allocation", CONTROL)
@pytest.mark.parametrize("ident", ["S-0-0405", "S-0-0406"])
def test_a_real_time_bit_that_has_an_enable_writes_it_in_each_cycle(
    allocation: str, ident: str
) -> None:
    hand = Hand(profile="two_probes")
    assert hand.written(allocation, named(ident)) is None
    other = next(each for each in ("S-0-0405", "S-0-0406") if each != ident)
    mine, rest = BITS[allocation], (BIT_1 | BIT_2) & ~BITS[allocation]
    for control in (mine, 0, rest, mine | rest, rest):
        hand.cycle(control)
        assert (hand.number(ident), hand.number(other)) == (int(bool(control & mine)), 0)


E1, P1, N1 = (int(ProbeFunction[name]) for name in ("ENABLE_1", "POSITIVE_1", "NEGATIVE_1"))
CONTINUOUS, SECOND_ENCODER = int(ProbeFunction.CONTINUOUS_1), 1 << 14


@pytest.mark.parametrize(
    ("profile", "select", "enables", "function"),
    [
        ("one_probe", 0b0001, (1, 0), E1 | P1),
        ("one_probe", 0b0010, (1, 0), E1 | N1),
        ("one_probe", 0b0011, (1, 0), E1 | P1 | N1),
        ("one_probe", 0b0001, (0, 0), 0),
        ("one_probe", 0x21, (1, 0), E1 | P1 | CONTINUOUS),
        ("one_probe", 0x20, (1, 0), 0),  # no edge, nothing goes on
        ("two_probes", 0b0001, (0, 1), 0),  # the enable of the other one
        ("two_probes", 0b0100, (1, 0), 0),
        ("two_probes", 0b0100, (0, 1), (E1 | P1) << 8 | SECOND_ENCODER),
        ("two_probes", 0b1000, (0, 1), (E1 | N1) << 8 | SECOND_ENCODER),
        ("two_probes", 0b1111, (1, 1), (E1 | P1 | N1) * 0x101 | SECOND_ENCODER),
        ("two_probes", 0b1111, (1, 0), E1 | P1 | N1),
        ("two_probes", 0b0110, (1, 1), E1 | N1 | (E1 | P1) << 8 | SECOND_ENCODER),
    ],
)
def test_an_edge_is_armed_that_is_selected_and_enabled_while_the_cycle_runs(
    profile: str, select: int, enables: tuple[int, int], function: int
) -> None:
    """60B8 (CiA 402) of the probe unit; probe 2 takes the second encoder."""
    hand = in_phase(3, profile)
    assert hand.written(SELECT, word(select)) is None
    for name, enable in zip(("S-0-0405", "S-0-0406"), enables, strict=True):
        hand.written(name, word(enable))
    image = hand.drive.servo.image
    assert image.probe_function == 0
    hand.written(COMMAND, word(3))
    assert image.probe_function == function
    hand.written(COMMAND, word(0))
    assert image.probe_function == 0


@pytest.mark.parametrize(("select", "state"), [(0x101, "RUNNING"), (0x001, "IDLE")])
def test_the_probing_cycle_begins_with_op_where_bit_8_is_set(select: int, state: str) -> None:
    hand = in_phase(2)
    assert hand.written(SELECT, word(select)) is None
    for ident in ("S-0-0001", "S-0-0002"):
        assert hand.written(ident, word(1000)) is None
    hand.drive.states.state = AlState.SAFEOP
    assert hand.drive._enter_op() == WAITS
    assert hand.state(COMMAND) == state


@pytest.mark.parametrize(
    ("control_us", "bus_us"), [(1000, 1000), (2000, 1000), (1000, 2000), (500, 500)]
)
def test_cycles_that_differ_keep_the_drive_out_of_phase_4(control_us: int, bus_us: int) -> None:
    """S-0-0128 names both, and OP is refused; when they are the same again it is not."""
    hand = in_phase(2)
    assert hand.written("S-0-0001", word(control_us)) is None
    assert hand.written("S-0-0002", word(bus_us)) is None
    is_same = control_us == bus_us
    hand.drive.states.state = AlState.SAFEOP
    for _ in range(2):
        assert hand.written("S-0-0128", word(3)) is None
        assert hand.state("S-0-0128") == ("DONE" if is_same else "FAILED")
        found = hand.drive.idents.items(ident_number("S-0-0022"))
        assert found == ([] if is_same else [1, 2])
        assert hand.drive._enter_op() == (WAITS if is_same else "INVALID_SYNC_CYCLE")
        hand.written("S-0-0128", word(0))
        hand.drive.states.state = AlState.PREOP
        assert hand.written("S-0-0001", word(bus_us)) is None
        hand.drive.states.state = AlState.SAFEOP
        is_same = True


def test_a_drive_that_gets_power_again_has_no_error_and_no_command_of_before() -> None:
    hand = Hand()
    hand.cycle(FOLLOW, 8)
    hand.written(SELECT, word(1))
    hand.written(COMMAND, word(3))
    hand.fault(0x2310)
    assert hand.cycle(0, 8) & C1D
    assert hand.number("S-0-0011") != 0
    drive, diagnosis = hand.drive, ident_number("S-0-0390")
    healthy = Hand().number("S-0-0390")
    assert drive.idents.number(diagnosis) != healthy
    drive.power_off()
    drive.power_on()
    assert drive.idents.number(ident_number("S-0-0011")) == 0
    assert drive.idents.number(diagnosis) == healthy
    assert drive.idents.number(ident_number("S-0-0134")) == 0
    assert drive.idents.items(ident_number("S-0-0016")) == [ident_number("S-0-0051")]
    assert not drive.probing.is_running
    assert hand.drive.phase == 2


@pytest.mark.parametrize(
    ("state", "phase"),
    [(AlState.INIT, 2), (AlState.PREOP, 2), (AlState.SAFEOP, 3), (AlState.OP, 4)],
)
def test_the_phase_is_that_of_the_state_of_the_slave(state: AlState, phase: int) -> None:
    hand = Hand()
    hand.drive.states.state = state
    assert (hand.drive.phase, hand.number("S-0-0014")) == (phase, phase)


def test_a_list_of_a_telegram_keeps_its_order_and_can_be_emptied() -> None:
    hand = in_phase(2, "two_probes")
    for names in (["S-0-0051", "S-0-0130"], ["S-0-0133", "S-0-0051", "S-0-0130"], []):
        numbers = [ident_number(name) for name in names]
        assert hand.written("S-0-0016", pack_list(numbers, 2, len(numbers))) is None
        assert hand.drive.idents.items(ident_number("S-0-0016")) == numbers
