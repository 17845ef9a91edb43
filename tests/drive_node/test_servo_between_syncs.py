"""What a servo shows and does at once: faults, limits, switches and probes from tick to tick."""

from typing import Any

import pytest
from tests.drive_node.servo_alone import LIMITED, PER_M, ServoAlone

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS, US

RATED_N = DriveProfile().rated_force_n
NO_LIMIT_N = 65.535 * RATED_N
"""6072, 60E0 and 60E1 are UNSIGNED16 in per mille of the rated torque; FFFF is no limit."""
WARNING = 1 << 7
MET, GONE = (0x8612, 0x21, 0), (0, 0, 0)


# Faults


@pytest.mark.parametrize(
    ("option", "state"), [(0, "FAULT_REACTION_ACTIVE"), (1, "FAULT_REACTION_ACTIVE")]
)
@pytest.mark.parametrize("bits", [0x0F, 0x06])
def test_a_fault_is_in_the_statusword_at_once(
    fake_axis: Any, option: int, state: str, bits: int
) -> None:
    """6041: xx0x 1111 = reaction active, before any SYNC and with the emergency."""
    one = ServoAlone(fake_axis(), 9, fault_option=option, target_velocity=0.1 * PER_M)
    one.cycle()
    if bits == 0x06:
        one.cycle(controlword=0x06)
    shown: list[int] = []

    class Sent(list[tuple[int, int, int]]):
        def append(self, error: tuple[int, int, int]) -> None:
            super().append(error)
            shown.append(one.image.statusword)

    one.sent = Sent()
    one.servo.fault(0x2310, 1 << 1, one.now_ns)
    assert one.servo.state.name == state
    assert one.image.statusword & 0x4F == 0x0F
    assert shown == [one.image.statusword]
    assert one.sent == [(0x2310, 0x03, 0)]
    one.run_ms(400)
    assert one.servo.state is State.FAULT
    assert one.image.statusword & 0x4F == 0x08


@pytest.mark.parametrize("sign", [1, -1])
def test_a_fault_that_is_no_following_error_brakes_the_demand(fake_axis: Any, sign: int) -> None:
    """A plant of positions alone: the ramp goes on from where the demand is, 50 um ahead."""
    axis = fake_axis(motion=lambda time_s: sign * 0.02 * time_s)
    axis.kinds = frozenset({ControlKind.POSITION})
    one = ServoAlone(axis, 8, fault_option=1, profile_deceleration=10 * PER_M)
    for _ in range(3):
        place_m = sign * 0.02 * (one.now_ns + MS) * 1e-9
        one.cycle(target_position=(place_m + sign * 50e-6) * PER_M)
    clock = one.clock
    clock.run_until(one.now_ns + 500 * US)
    axis.advance_to(one.now_ns)
    demand_m = axis.demand_position_m()
    count = len(axis.commands)
    one.servo.fault(0x2310, 1 << 1, one.now_ns)
    assert axis.commands[count].position_m == pytest.approx(demand_m, abs=1e-12)
    assert abs(demand_m - axis.motor_position_m()) > 20e-6
    assert axis.commands[count].velocity_m_s * sign > 0.015


def test_a_bit_that_goes_is_reported_as_one_that_comes(fake_axis: Any) -> None:
    """Between two SYNCs a tick takes the warning back: that is a change of the statusword."""
    axis = fake_axis(motion=lambda time_s: 50e-6 if time_s < 9e-3 else 0.0)
    one = ServoAlone(axis, 8, following_window=40e-6 * PER_M, following_timeout_ms=100)
    one.write(target_position=0)
    while one.now_ns < 8 * MS:
        one.cycle(target_position=0)
    assert one.image.statusword & WARNING
    before = one.changes
    one.run_ms(0.9)
    assert one.changes == before
    one.run_ms(0.4)  # the tick at 9.25 ms
    assert one.image.statusword & WARNING == 0
    assert one.changes == before + 1


# Quick stop


@pytest.mark.parametrize("code", [1, 2, 3, 4, 5, 6, 7, 8])
def test_a_quick_stop_that_stays_active_holds_the_axis_for_ever(fake_axis: Any, code: int) -> None:
    """605A 5 to 8: at standstill the drive is in quick stop active with torque; 1 to 4 without."""
    one = ServoAlone(
        fake_axis(), 9, quick_stop_option=code, target_velocity=0.1 * PER_M,
        quick_stop_deceleration=10 * PER_M, profile_deceleration=10 * PER_M,
    )  # fmt: skip
    one.cycle()
    one.cycle(controlword=0x02)
    for _ in range(40):
        one.cycle()
    stays = code > 4
    assert one.servo.state.name == ("QUICK_STOP_ACTIVE" if stays else "SWITCH_ON_DISABLED")
    assert one.axis.commands[-1].enabled is stays
    commands = one.axis.commands[-5:]
    for _ in range(5):
        one.cycle()
    assert one.axis.commands[-1].enabled is stays
    assert one.axis.demand_velocity_m_s() == 0.0
    if stays:  # nothing is given any more, and the axis can go on from there
        assert one.axis.commands[-5:] == commands
        one.cycle(controlword=0x0F)
        for _ in range(3):
            one.cycle()
        assert one.axis.demand_velocity_m_s() == pytest.approx(0.1)


# Limits that a PDO brings


@pytest.mark.parametrize("mode", [8, 9, 10])
def test_a_torque_limit_acts_with_the_sync_that_brings_it_whatever_else_stays(
    fake_axis: Any, mode: int
) -> None:
    """The controlword is the same in each cycle."""
    one = ServoAlone(fake_axis(), mode)
    one.cycle()
    for negative, positive, most in (
        (300, 400, 0xFFFF), (0xFFFF, 400, 0xFFFF), (300, 400, 350), (0xFFFF,) * 3,
    ):  # fmt: skip
        one.cycle(negative_torque_limit=negative, positive_torque_limit=positive, max_torque=most)
        wanted = (min(negative, most) / 1000 * RATED_N, min(positive, most) / 1000 * RATED_N)
        assert one.axis.limits[-1] == pytest.approx(wanted)
    assert max(one.axis.limits[-1]) == pytest.approx(NO_LIMIT_N)


# Switches


def test_a_home_switch_alone_is_seen(fake_axis: Any, fake_signal: Any) -> None:
    """Bit 2 of 60FD, on and off again; no limit switch is wired."""
    axis = fake_axis()
    one = ServoAlone(axis, switches={"home": fake_signal(axis, [5 * MS, 8 * MS])})
    shown = []
    for _ in range(8):  # the SYNCs from 4 ms on
        one.cycle()
        shown.append(one.image.digital_inputs)
    assert shown == [0, 0, 4, 4, 4, 0, 0, 0]
    assert one.image.statusword & LIMITED == 0
    assert one.sent == []


@pytest.mark.parametrize(("name", "sign"), [("positive", 1), ("negative", -1)])
@pytest.mark.parametrize(("quick", "slow"), [(10.0, 2.5), (2.5, 10.0)])
def test_a_limit_switch_stops_with_the_ramp_of_the_quick_stop(
    fake_axis: Any, fake_signal: Any, name: str, sign: int, quick: float, slow: float
) -> None:
    """6085 and not 6084: 0.1 m/s end after 0.1/a."""
    axis = fake_axis()
    one = ServoAlone(
        axis, 9, target_velocity=sign * 0.1 * PER_M, quick_stop_deceleration=quick * PER_M,
        profile_deceleration=slow * PER_M, switches={name: fake_signal(axis, [6 * MS])},
    )  # fmt: skip
    while one.now_ns < 7 * MS:
        one.cycle()
    command = axis.commands[-1]
    assert command.acceleration_m_s2 == pytest.approx(-sign * quick, rel=1e-6)
    assert command.end_ns - command.time_ns == pytest.approx(0.1 / quick * 1e9, rel=1e-3)


@pytest.mark.parametrize(("name", "sign"), [("positive", 1), ("negative", -1)])
def test_a_limit_switch_that_is_left_without_power_is_an_error_no_more(
    fake_axis: Any, fake_signal: Any, name: str, sign: int
) -> None:
    """Pushed back by hand: the emergency ends, and both ways are free when there is power."""
    axis = fake_axis()
    one = ServoAlone(
        axis, 9, target_velocity=sign * 0.1 * PER_M, quick_stop_deceleration=10 * PER_M,
        switches={name: fake_signal(axis, [6 * MS, 30 * MS])},
    )  # fmt: skip
    while one.now_ns < 25 * MS:
        one.cycle()
    assert (one.sent, one.image.error_register) == ([MET], 0x21)
    one.cycle(controlword=0, target_velocity=0)
    assert one.image.statusword & LIMITED
    while one.now_ns < 35 * MS:
        one.cycle()
    assert (one.sent, one.image.error_register) == ([MET, GONE], 0)
    assert one.image.statusword & LIMITED == 0
    for word in (0x06, 0x07, 0x0F, 0x0F):
        one.cycle(controlword=word)
    one.cycle(target_velocity=sign * 0.1 * PER_M)
    one.cycle()
    assert axis.demand_velocity_m_s() == pytest.approx(sign * 0.1)


# Probes


def test_power_takes_what_the_probes_have_latched_and_their_arming(
    fake_axis: Any, fake_signal: Any
) -> None:
    """60B9 is 0, positions, stamps and counters are 0; armed anew they latch anew."""
    axis = fake_axis(motion=lambda time_s: 0.1 * time_s)
    edges = [[5 * MS, 6 * MS, 25 * MS, 26 * MS], [5 * MS + 500 * US, 6 * MS, 27 * MS, 28 * MS]]
    signals = tuple(fake_signal(axis, each) for each in edges)
    one = ServoAlone(axis, signals=signals)
    one.cycle(probe_function=0x3131)
    while one.now_ns < 10 * MS:
        one.cycle()
    image = one.image
    assert image.probe_status == 0x0707
    assert [probe.status for probe in one.servo.touch_probe.probes] == [7, 7]
    names = [
        f"{what}_{number}_{edge}" for what in ("latch", "stamp", "count") for number in (1, 2)
        for edge in ("positive", "negative")
    ]  # fmt: skip
    assert all(getattr(image, name) for name in names)
    one.servo.reset(one.now_ns)
    assert {name: getattr(image, name) for name in names} == dict.fromkeys(names, 0)
    assert (image.probe_status, image.probe_function) == (0, 0)
    assert [probe.is_enabled for probe in one.servo.latches] == [False, False]
    while one.now_ns < 20 * MS:
        one.cycle()
    assert image.probe_status == 0
    one.cycle(probe_function=0x3131)
    assert image.probe_status == 0x0101
    while one.now_ns < 30 * MS:
        one.cycle()
    assert image.probe_status == 0x0707
    assert [getattr(image, name) for name in names if name.startswith("count")] == [1] * 4
    assert image.latch_1_positive == round(0.1 * 25.004e-3 * PER_M)  # 4 us of the input
