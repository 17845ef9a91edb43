"""Values of a PROFIdrive drive: second encoder, other screws, more than 100 percent."""

from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis
from tests.profidrive.test_power_and_edges_of_a_drive import ACTIVATE, POS, READ, SPEED_M_S, Probing
from tests.profidrive.test_profidrive_node import OFF, Node

from axisrig.bench.drive.profidrive.node import ProfidriveDrive
from axisrig.bench.drive.profidrive.parameters import DriveParameters
from axisrig.bench.rig.profidrive.keys import DriveTable
from axisrig.kernel.profiles.profidrive import words
from axisrig.kernel.time.clock import MS

V_M_S = 0.03


def wrapped(value: int) -> int:
    return (value + (1 << 31)) % (1 << 32) - (1 << 31)


@pytest.mark.parametrize("beside_m", [1e-3, -2.5e-3])
@pytest.mark.parametrize("telegram", [4, 6])
def test_the_second_encoder_is_beside_the_first(telegram: int, beside_m: float) -> None:
    """G2_XIST1 of telegrams 4 and 6, in increments of the first."""
    axis = FakeAxis(motion=lambda time_s: V_M_S * time_s, encoder_2_m=beside_m)
    one = Node(axis, telegram)
    for ms in range(1, 6):
        one.cycle()
        per_m = one.per_mm * 1000
        assert one.shown("G1_XIST1") == round(V_M_S * ms * 1e-3 * per_m)
        assert one.shown("G2_XIST1") == round((V_M_S * ms * 1e-3 + beside_m) * per_m)


@pytest.mark.parametrize("late", [0, 1, 3])
def test_a_second_encoder_that_is_late_is_so_by_samples(late: int) -> None:
    """What a drive reads from it in each cycle, and shows so many telegrams later."""
    axis = FakeAxis(motion=lambda time_s: V_M_S * time_s, encoder_2_m=0.0)
    made = DriveTable.model_validate(
        {"family": "profidrive", "telegram": 6, "second_delay_cycles": late}
    ).make()
    one = Node(axis, 6)
    one.node = ProfidriveDrive("Z", one.clock, axis, (None, None), made)
    for _ in range(4):
        one.cycle()
    for _ in range(5):
        one.cycle()
        here_ms = one.clock.now_ns / MS
        per_ms = V_M_S * one.per_mm
        assert one.shown("G1_XIST1") == round(here_ms * per_ms)
        assert one.shown("G2_XIST1") == round((here_ms - late) * per_ms)


@pytest.mark.parametrize("lead_mm", [5, 10, 20])
@pytest.mark.parametrize("share", [0.05, -0.05])
def test_a_speed_is_a_share_of_p0880_turns_of_the_screw(lead_mm: int, share: float) -> None:
    """3000 rpm are 50 turns in a second."""
    one = Node(FakeAxis(), lead_mm=lead_mm, p0880=3000)
    one.operate()
    one.cycle(NSOLL_B=share * words.SPEED_BASE)
    expected = share * 50 * lead_mm * 1e-3
    assert one.axis.demand_velocity_m_s() == pytest.approx(expected, rel=1e-6)
    one.cycle()
    assert one.shown("NIST_B") == pytest.approx(share * words.SPEED_BASE, rel=1e-6)


@pytest.mark.parametrize("share", [-2.0, -1.5, -1.0, 1.0, 1.5, 1.999])
def test_a_set_speed_goes_to_200_percent_in_both_directions(share: float) -> None:
    """2^30 are P0880: 600 rpm of 10 mm, 0.1 m/s; the motor can do more."""
    one = Node(FakeAxis(), p0880=600)
    one.operate()
    one.cycle(NSOLL_B=share * words.SPEED_BASE)
    assert one.axis.demand_velocity_m_s() == pytest.approx(share * 0.1, rel=1e-6)


@pytest.mark.parametrize("place_m", [1.5, -1.5, 4.0, -4.0])
@pytest.mark.parametrize(("p1043", "factor"), [(13, 4), (11, 1)])
def test_an_absolute_position_outside_32_bits_wraps(
    place_m: float, p1043: int, factor: int
) -> None:
    """4194304 increments a turn of 10 mm: 2^31 are 5.12 m, with two fine bits more 1.28 m."""
    one = Node(FakeAxis(motion=lambda _: place_m), 105, p1042=11, p1043=p1043)
    one.cycle()
    one.cycle(STW1=1 << 10, G1_STW=words.ABSOLUTE)
    one.cycle()
    increments = round(place_m * 1e3 * one.per_mm)
    assert one.shown("G1_XIST1") == increments
    assert one.shown("G1_XIST2") == wrapped(increments * factor)


def test_power_takes_the_control_word_of_the_encoder() -> None:
    """It asked for a function; nothing is active until a telegram asks again."""
    one = Probing((21_250_000,))
    one.until(3, STW1=OFF)
    one.until(8, STW1=OFF, G1_STW=ACTIVATE | POS)
    assert one.shown("G1_ZSW") & 0xFF == POS
    one.node.power_off()
    one.node.power_on()
    for _ in range(5):
        one.cycle(is_sent=False)
        assert one.shown("G1_ZSW") & 0xFF == 0
    one.cycle(G1_STW=ACTIVATE | POS)
    one.cycle()
    assert one.shown("G1_ZSW") & 0xFF == POS


@pytest.mark.parametrize("is_before", [True, False])
def test_an_edge_between_the_sample_and_the_set_values_is_taken_before_them(
    is_before: bool,
) -> None:
    """The command to read comes in the cycle of the edge: the value is there, or not yet."""
    edge_ns = 5 * MS + (300_000 if is_before else 700_000)
    one = Probing((edge_ns,))
    one.until(3, STW1=OFF)
    one.until(5, STW1=OFF, G1_STW=ACTIVATE | POS)
    one.life = words.next_life(one.life)
    one.given |= {"STW2": one.life << 12, "G1_STW": READ | POS}
    one.node.sample()
    one.node.exchange(words.codec_of(one.telegram.to_drive).pack(*one.given.values()))
    one.clock.run_until(5 * MS + 500_000)
    one.node.cycle()
    shown = round(edge_ns * 1e-6 * SPEED_M_S * one.per_mm) if is_before else 0
    assert one.node.encoder.value(0) == shown


@pytest.mark.parametrize("telegram", [3, 4, 5, 6, 105])
def test_the_number_of_the_telegram_is_a_parameter(telegram: int) -> None:
    table = DriveTable.model_validate({"family": "profidrive", "telegram": telegram})
    answer = DriveParameters(table.make()).answer(bytes.fromhex("01010001 1001039A0000"))
    assert int.from_bytes(answer[-2:], "big") == telegram


GIVEN: dict[str, Any] = {
    "p0660": 3, "p0880": 4500, "p0881": 70, "p0925": 4, "p1042": 12, "p1043": 9, "p1230": 1750,
}  # fmt: skip


@pytest.mark.parametrize("key", GIVEN)
def test_each_parameter_begins_with_the_value_of_the_rig(key: str) -> None:
    """And has it again after a reset."""
    table = DriveTable.model_validate({"family": "profidrive"} | GIVEN)
    drive, number = DriveParameters(table.make()), int(key[1:])
    assert drive.values[number] == GIVEN[key]
    drive.values[number] = 1
    drive.reset()
    assert drive.values[number] == GIVEN[key]


@pytest.mark.parametrize("p0660", [0, 79, 80, 81])
def test_the_fast_input_is_that_of_the_probe_at_80_alone(p0660: int) -> None:
    """P0660 may change while a function waits: off, on, off."""
    one = Probing((9_250_000,), p0660=p0660)
    one.until(3, STW1=OFF)
    one.until(6, STW1=OFF, G1_STW=ACTIVATE | POS)
    assert (one.node.image.probe_function != 0) is (p0660 == 80)
    one.node.parameters.values[660] = 80
    one.until(12)
    assert one.shown("G1_ZSW") & 0xFF == POS << words.VALUE_SHIFT
    assert one.shown("G1_ZSW") >> 8 & 1  # deflected
    one.node.parameters.values[660] = 0
    one.cycle()
    one.cycle()
    assert one.shown("G1_ZSW") >> 8 & 1 == 0


def test_a_command_without_a_function_asks_for_nothing() -> None:
    """Neither flying measurement nor reference search: no bit of a function is set."""
    one = Probing()
    one.until(3, STW1=OFF)
    for command in (words.ACTIVATE, words.READ, words.ABORT):
        one.cycle(G1_STW=command << words.COMMAND_SHIFT)
        one.cycle()
        assert (one.shown("G1_ZSW"), one.shown("G1_XIST2")) == (0, 0)


@pytest.mark.parametrize("tolerated", [1, 3])
def test_signs_of_life_are_tolerated_as_p0925_says_now(tolerated: int) -> None:
    """It is written while the drive runs: from then on it counts."""
    one = Node(FakeAxis(), p0925=10)
    one.operate()
    one.node.parameters.values[925] = tolerated
    held = one.life
    states = []
    for _ in range(tolerated + 1):
        one.cycle(life=held)
        states.append(one.node.state.name)
    assert states[:-1] == ["OPERATION_ENABLED"] * tolerated
    assert states[-1] != "OPERATION_ENABLED"


def test_no_parameter_is_answered_without_power() -> None:
    one = Node(FakeAxis())
    request = bytes.fromhex("01010001 1001039A0000")
    assert one.node.answer(request)
    one.node.power_off()
    assert one.node.answer(request) == b""
    one.node.power_on()
    assert one.node.answer(request)
