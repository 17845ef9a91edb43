"""A PROFIdrive drive alone, given telegram 105 word by word in each cycle of 1 ms.

Each cycle samples, swaps telegrams and takes the set values, in this order.
"""

from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis

from axisrig.bench.drive.profidrive.node import ProfidriveDrive
from axisrig.bench.rig.profidrive.keys import DriveTable
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.profidrive import words
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

OPERATE = 0x047F  # ON, no OFF2 and OFF3, enabled, set value taken; by the control
OFF = OPERATE & ~words.ON
LIMITED = 1 << 11


class Node:
    """The drive and what it was given last; the lead is 10 mm, P0880 16384 rpm."""

    def __init__(self, axis: FakeAxis, telegram: int = 105, **keys: Any) -> None:
        table = DriveTable.model_validate({"family": "profidrive", "telegram": telegram, **keys})
        made = table.make()
        self.clock, self.axis, self.per_mm = new_scheduler(), axis, float(table.per_mm)
        self.node = ProfidriveDrive("Z", self.clock, axis, (None, None), made)
        self.telegram = made.telegram
        self.per_m_s = words.SPEED_BASE / (16_384 / 60 * 0.01)
        self.given: dict[str, int] = dict.fromkeys(self.telegram.to_drive, 0)
        self.life = 0
        self.clock.run_until(0)

    def cycle(self, *, life: int | None = None, is_sent: bool = True, **values: float) -> None:
        """Run a cycle with these words changed; life: instead of the next right one."""
        self.clock.run_until(self.clock.now_ns + MS)
        self.life = words.next_life(self.life) if life is None else life
        self.given["STW2"] = self.life << 12
        self.given |= {name: round(value) for name, value in values.items()}
        self.node.sample()
        data = words.codec_of(self.telegram.to_drive).pack(*self.given.values())
        self.node.exchange(data if is_sent else None)
        self.node.cycle()

    def operate(self) -> None:
        """Walk to operation: ON has to be 0 first, then one state in each cycle."""
        for word in (OFF, OFF, *[OPERATE] * 4):
            self.cycle(STW1=word)
        assert self.node.state is State.OPERATION_ENABLED

    def shown(self, name: str) -> int:
        """Return a word of the telegram that was sampled last."""
        names = self.telegram.from_drive
        values = words.codec_of(names).unpack(self.node.inputs)
        return int(dict(zip(names, values, strict=True))[name])


@pytest.mark.parametrize("sign", [1, -1])
def test_the_set_speed_is_a_share_of_p0880_and_limited_by_the_motor(sign: int) -> None:
    one = Node(FakeAxis())
    one.operate()
    one.cycle(NSOLL_B=sign * 0.25 * one.per_m_s)
    assert one.axis.demand_velocity_m_s() == pytest.approx(sign * 0.25, rel=1e-6)
    assert one.node.image.statusword & LIMITED == 0
    one.node.image.max_motor_speed = 600  # 0.1 m/s
    one.node.servo.update()
    one.cycle()
    assert one.axis.demand_velocity_m_s() == pytest.approx(sign * 0.1)
    assert one.node.image.statusword & LIMITED
    one.cycle(NSOLL_B=sign * 0.05 * one.per_m_s)
    assert one.axis.demand_velocity_m_s() == pytest.approx(sign * 0.05, rel=1e-6)
    assert one.node.image.statusword & LIMITED == 0
    one.cycle()
    assert one.shown("NIST_B") == pytest.approx(sign * 0.05 * one.per_m_s, rel=1e-4)


@pytest.mark.parametrize(
    ("v_m_s", "shown"),
    [
        (0.75, 3 << 29),
        (-0.75, -3 << 29),
        (1.2, (1 << 31) - 1),
        (-1.2, -1 << 31),
        (4.0, (1 << 31) - 1),
    ],
)
def test_an_axis_beyond_200_percent_is_shown_with_the_largest_speed(
    v_m_s: float, shown: int
) -> None:
    """2^30 are P0880, 3000 rpm of 10 mm: 0.5 m/s; a word of 32 bits ends below twice that."""
    one = Node(FakeAxis(motion=lambda time_s: v_m_s * time_s), p0880=3000)
    one.cycle()
    assert one.shown("NIST_B") == pytest.approx(shown, rel=1e-6)
    assert -1 << 31 <= one.shown("NIST_B") < 1 << 31


@pytest.mark.parametrize(
    ("v_m_s", "xerr_m"), [(0.02, 0.0004), (-0.05, 0.0004), (0.02, -0.0002), (0.02, 0.0)]
)
def test_dsc_adds_the_deviation_from_where_the_control_has_reckoned_it(
    v_m_s: float, xerr_m: float
) -> None:
    """n = NSOLL_B + KPC (XERR - (x - x0)), x0 of the telegram before the one that is swapped.

    That is one cycle of 1 ms before, and a tick 250 us later the axis is so much further.
    """
    one = Node(FakeAxis(motion=lambda time_s: v_m_s * time_s))
    one.operate()
    kpc, speed_m_s = 25.0, 0.01
    increments = xerr_m * 1e3 * one.per_mm
    for _ in range(2):
        one.cycle(KPC=kpc * 1000, XERR=increments, NSOLL_B=speed_m_s * one.per_m_s)
    for passed_ms in (0.0, 0.25, 0.75):
        moved_m = v_m_s * (1.0 + passed_ms) * 1e-3
        one.clock.run_until(round(one.clock.now_ns // MS * MS + passed_ms * MS))
        wanted = speed_m_s + kpc * (xerr_m - moved_m)
        assert one.axis.commands[-1].velocity_m_s == pytest.approx(wanted, abs=2e-6)
    one.cycle(KPC=0)
    commands = len(one.axis.commands)
    assert one.axis.commands[-1].velocity_m_s == pytest.approx(speed_m_s, abs=1e-6)
    one.clock.run_until(one.clock.now_ns + MS - 1)
    assert len(one.axis.commands) == commands  # no loop, no ticks
    one.cycle(KPC=-5000)
    assert one.axis.commands[-1].velocity_m_s == pytest.approx(speed_m_s, abs=1e-6)


def test_without_bit_10_the_sign_of_life_alone_is_taken() -> None:
    one = Node(FakeAxis(), p0925=1)
    one.operate()
    one.cycle(NSOLL_B=0.1 * one.per_m_s)
    for _ in range(40):
        one.cycle(STW1=0, NSOLL_B=0, MOMRED=8192)
    assert one.node.state is State.OPERATION_ENABLED
    assert one.axis.demand_velocity_m_s() == pytest.approx(0.1, rel=1e-6)
    assert one.node.image.max_torque == 1000
    for _ in range(3):
        one.cycle(life=one.life)
    assert one.node.state.name in ("FAULT_REACTION_ACTIVE", "FAULT")


def test_a_lost_sign_of_life_is_forgotten_with_its_fault() -> None:
    """Acknowledged, the drive has its whole patience again: P0925 wrong ones."""
    one = Node(FakeAxis(), p0925=2)
    for _ in range(2):
        one.operate()
        for _ in range(2):
            one.cycle(life=7)
            one.cycle(life=7)
        for _ in range(20):
            one.cycle(life=7)
        assert one.node.state is State.FAULT
        one.cycle(STW1=OFF | words.ACKNOWLEDGE, life=8)
        one.life = 8
        for _ in range(30):
            one.cycle(STW1=OFF)
        assert one.node.state.name == "READY_TO_SWITCH_ON"
    one.operate()
    for _ in range(2):
        one.cycle(is_sent=False)
    assert one.node.state.name == "OPERATION_ENABLED"


def test_an_acknowledge_in_operation_is_none() -> None:
    one = Node(FakeAxis())
    one.operate()
    one.cycle(STW1=OPERATE | words.ACKNOWLEDGE, NSOLL_B=0.1 * one.per_m_s)
    one.cycle()
    assert one.node.state is State.OPERATION_ENABLED
    assert one.axis.demand_velocity_m_s() == pytest.approx(0.1, rel=1e-6)


def test_power_takes_what_telegrams_have_set() -> None:
    """Torque reduction, control words and signs of life of before do not count afterwards."""
    one = Node(FakeAxis())
    one.operate()
    one.cycle(MOMRED=8192)
    assert one.node.image.max_torque == 500
    one.node.power_off()
    for _ in range(3):
        one.cycle()
        assert one.node.inputs == b""
    one.node.power_on()
    assert one.shown("ZSW2") >> 12 == 1
    for number in range(1, 20):
        one.cycle(is_sent=False)
        assert one.node.image.max_torque == 1000
        assert one.shown("ZSW2") >> 12 == number % 15 + 1
    assert one.node.state.name == "SWITCH_ON_DISABLED"


@pytest.mark.parametrize(("p1043", "factor"), [(11, 1.0), (13, 4.0), (9, 0.25)])
@pytest.mark.parametrize("place_m", [0.0123, -0.0123])
def test_the_absolute_position_has_fine_bits_of_its_own(
    p1043: int, factor: float, place_m: float
) -> None:
    """P1043 less P1042 bits more or fewer than G1_XIST1."""
    one = Node(FakeAxis(motion=lambda _: place_m), 5, p1042=11, p1043=p1043)
    one.cycle()
    one.cycle(STW1=1 << 10, G1_STW=words.ABSOLUTE)
    one.cycle()
    assert one.shown("G1_XIST1") == round(place_m * 1e3 * one.per_mm)
    assert one.shown("G1_XIST2") == pytest.approx(place_m * 1e3 * one.per_mm * factor, abs=1)


@pytest.mark.parametrize("word", range(4))
def test_zsw1_shows_off2_and_off3_as_they_were_taken(word: int) -> None:
    """PROFIdrive: bits 4 and 5 of ZSW1 are bits 1 and 2 of STW1; by the control, bit 10, alone."""
    one = Node(FakeAxis())
    for given in (word, 3, word ^ 3, 0):
        one.cycle(STW1=1 << 10 | given << 1)
        one.cycle()
        assert one.shown("ZSW1") >> 4 & 3 == given
    one.cycle(STW1=1 << 10 | 3 << 1)
    one.cycle(STW1=0)
    one.cycle()
    assert one.shown("ZSW1") >> 4 & 3 == 3
    assert one.shown("ZSW1") >> 9 & 1  # control requested
    one.node.power_off()
    one.node.power_on()
    for _ in range(3):
        one.cycle(is_sent=False)
        assert one.shown("ZSW1") >> 4 & 3 == 0


@pytest.mark.parametrize(
    ("gain", "kpc_per_s"),
    [(3_999_000, 3999), (4_000_000, 4000), (4_000_001, 4000), (1 << 30, 4000)],
)
def test_a_gain_is_at_most_4000_per_s(gain: int, kpc_per_s: float) -> None:
    """KPC counts 0.001 1/s; 0.02 mm away the axis gets KPC times that."""
    one = Node(FakeAxis(motion=lambda _: 0.0))
    one.operate()
    for _ in range(2):
        one.cycle(KPC=gain, XERR=0.02 * one.per_mm, NSOLL_B=0)
    assert one.axis.commands[-1].velocity_m_s == pytest.approx(kpc_per_s * 0.02e-3, rel=1e-3)
