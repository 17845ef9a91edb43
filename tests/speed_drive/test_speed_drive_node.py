"""A drive that only takes a speed, alone: given its image in each cycle of 1 ms."""

from typing import Any

import pytest
from tests.drive_node.conftest import FakeAxis
from tests.speed_drive.ends import FAMILIES

from axisrig.bench.drive.speed_drive.node import SpeedDriveNode
from axisrig.bench.drive.speed_drive.profile import SpeedProfile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.speed_drive import words
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

PLACE = {"conventional": "COUNTER", "lightbus": "POSITION", "encoder_terminal": "COUNTER"}
LIMITED = 1 << 11


class Node:
    """The drive; each cycle samples, swaps images and takes what has come."""

    def __init__(self, family: str, axis: FakeAxis, **given: Any) -> None:
        made = FAMILIES[family]
        self.made = SpeedProfile(made.table.make().drive, **{"rpm_at_full": 3000.0, **given})
        self.clock, self.axis = new_scheduler(), axis
        self.to_drive, self.from_drive = made.images
        self.node = SpeedDriveNode(
            "Z", self.clock, axis, (None, None), self.made, made.images, made.unit()
        )
        self.clock.run_until(0)
        self.full_m_s = self.made.rpm_at_full / 60 * self.made.drive.lead_um * 1e-6

    def cycle(self, *, is_sent: bool = True, **values: int) -> dict[str, int]:
        """Run a cycle; return the values of the image that was sampled in it, none without one."""
        self.clock.run_until(self.clock.now_ns + MS)
        self.node.sample()
        data = self.node.exchange(self.to_drive.packed(values) if is_sent else None)
        self.node.cycle()
        return self.from_drive.values_of(data) if data else {}

    def operate(self, **values: Any) -> None:
        for _ in range(5):
            self.cycle(DRIVE=words.ENABLE, **values)
        assert self.node.state is State.OPERATION_ENABLED


@pytest.fixture(params=sorted(FAMILIES))
def family(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.mark.parametrize("counts", [32767, 8192, -8192, -32767, 0])
def test_the_speed_is_a_share_of_that_at_the_full_output(family: str, counts: int) -> None:
    one = Node(family, FakeAxis())
    one.operate(SPEED=counts)
    wanted = one.full_m_s * counts / 32767
    assert one.axis.demand_velocity_m_s() == pytest.approx(wanted)
    assert one.node.image.statusword & LIMITED == 0
    one.node.image.max_motor_speed = 60  # 10 mm/s
    one.node.servo.update()
    one.cycle(DRIVE=words.ENABLE, SPEED=counts)
    assert one.axis.demand_velocity_m_s() == pytest.approx(max(-0.01, min(wanted, 0.01)))
    assert bool(one.node.image.statusword & LIMITED) is (counts != 0)


@pytest.mark.parametrize(
    ("bits", "offset", "counts", "given"),
    [(16, 0, 1001, 1001), (12, 0, 1001, 992), (12, 0, -1001, -1008), (12, 0, 1008, 1008),
     (12, 5, 1001, 997), (12, -5, 0, -5), (8, 0, 255, 0), (8, 0, -1, -256), (8, 300, 256, 556)],
)  # fmt: skip
def test_an_output_cuts_its_lower_bits_off_and_has_its_offset(
    bits: int, offset: int, counts: int, given: int
) -> None:
    """The offset is of the output: it is not cut."""
    one = Node("conventional", FakeAxis(), output_bits=bits, output_offset=offset)
    assert one.made.given_out(counts) == given
    one.operate(SPEED=counts)
    speed_m_s = one.axis.commands[-1].velocity_m_s
    assert speed_m_s == pytest.approx(one.full_m_s * given / 32767)


@pytest.mark.parametrize("borne", [0, 1, 3])
def test_images_may_stay_out_so_often_in_a_row(family: str, borne: int) -> None:
    one = Node(family, FakeAxis(), watchdog_cycles=borne)
    one.operate(SPEED=8192)
    for _ in range(3):  # each image that comes begins the count anew
        for _ in range(borne):
            one.cycle(is_sent=False)
            assert one.axis.demand_velocity_m_s() > 0.0
        one.cycle(DRIVE=words.ENABLE, SPEED=8192)
    for _ in range(borne):
        one.cycle(is_sent=False)
    assert one.axis.demand_velocity_m_s() == pytest.approx(one.full_m_s * 8192 / 32767)
    assert one.node.state is State.OPERATION_ENABLED
    one.cycle(is_sent=False)
    assert one.node.servo.machine.waiting is not None  # it stops, then goes off
    for _ in range(200):
        one.cycle(is_sent=False)
    assert one.node.state.name == "READY_TO_SWITCH_ON"
    assert not one.axis.commands[-1].enabled


def test_a_unit_of_the_control_counts_on_without_the_drive_and_others_are_silent(
    family: str,
) -> None:
    """With power again the terminal counts from 0, and the others have the place of the encoder."""
    one = Node(family, FakeAxis(motion=lambda time_s: 0.0002 + 0.001 * time_s))
    increments = float(FAMILIES[family].table.per_mm)

    def place_mm() -> float:
        return 0.2 + one.clock.now_ns * 1e-9

    before = one.cycle()
    assert before["DRIVE"] & words.READY
    one.node.power_off()
    for _ in range(5):
        found = one.cycle(DRIVE=words.ENABLE)
        if family == "conventional":
            assert found["DRIVE"] == 0
            assert found["COUNTER"] == pytest.approx(place_mm() * increments, abs=1)
        else:
            assert found == {}
    one.node.power_on()
    begun_mm = place_mm() if family == "encoder_terminal" else 0.0
    for _ in range(5):
        found = one.cycle()
    assert found["DRIVE"] & words.READY
    count = (place_mm() - begun_mm) * increments
    assert found[PLACE[family]] == pytest.approx(count, abs=1.01)
    assert one.node.unit.has_own_power is (family == "conventional")


@pytest.mark.parametrize("with_enable", [0, words.ENABLE])
def test_a_reset_counts_before_the_enable(family: str, with_enable: int) -> None:
    one = Node(family, FakeAxis())
    one.operate()
    one.node.servo.fault(0x2310, 1 << 1, one.clock.now_ns)
    for _ in range(3):
        found = one.cycle(DRIVE=words.ENABLE)
    assert (one.node.state, found["DRIVE"]) == (State.FAULT, words.READY | words.FAULT)
    one.cycle(DRIVE=words.RESET | with_enable)
    found = one.cycle()
    assert (one.node.state.name, found["DRIVE"]) == ("SWITCH_ON_DISABLED", words.READY)
    one.operate()
    assert one.cycle(DRIVE=words.ENABLE)["DRIVE"] == words.READY | words.OPERATES


@pytest.mark.parametrize("is_sent", [False, True])
def test_with_power_again_a_drive_waits_for_an_enable_of_its_own(
    family: str, is_sent: bool
) -> None:
    """What it was asked before counts no more, neither without an image nor with one of 0."""
    one = Node(family, FakeAxis())
    one.operate(SPEED=8192)
    one.node.power_off()
    assert one.cycle(DRIVE=words.ENABLE, SPEED=8192).get("DRIVE", 0) == 0
    one.node.power_on()
    for _ in range(6):
        found = one.cycle(is_sent=is_sent)
        assert one.node.state is State.SWITCH_ON_DISABLED
        assert not one.axis.commands[-1].enabled
    assert found["DRIVE"] == words.READY
    one.operate(SPEED=-8192)
    wanted = one.full_m_s * -8192 / 32767
    assert one.axis.demand_velocity_m_s() == pytest.approx(wanted)


def test_after_the_watch_over_images_an_enable_is_asked_for_anew(family: str) -> None:
    """Images that come again with the enable lead it back into operation, with 0 they do not."""
    one = Node(family, FakeAxis(), watchdog_cycles=1)
    one.operate()
    for _ in range(200):
        one.cycle(is_sent=False)
    assert one.node.state.name == "READY_TO_SWITCH_ON"
    for _ in range(5):
        one.cycle()
    assert one.node.state.name == "READY_TO_SWITCH_ON"
    one.operate(SPEED=100)
    assert one.axis.demand_velocity_m_s() > 0.0


@pytest.mark.parametrize("has_power", [True, False])
def test_a_drive_without_power_takes_no_command_and_shows_none(
    family: str, has_power: bool
) -> None:
    one = Node(family, FakeAxis())
    if not has_power:
        one.node.power_off()
    for _ in range(5):
        one.cycle(DRIVE=words.ENABLE, SPEED=8192)
    assert one.node.is_on is has_power
    assert one.axis.commands[-1].enabled is has_power
