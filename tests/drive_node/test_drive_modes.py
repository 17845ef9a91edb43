"""Profile position, profile velocity, changes of mode, halt: set-points by closed forms.

The axis follows its demand exactly, so 6064 is the demand. Position units are 1/104857.6 mm.
"""

import math
from collections.abc import Callable
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import MS, US, S

Make = Callable[..., Any]
PER_M = 104_857_600
NEW, AT_ONCE, RELATIVE, HALT = 1 << 4, 1 << 5, 1 << 6, 1 << 8
REACHED, LIMITED, BIT_12 = 1 << 10, 1 << 11, 1 << 12


class Drive:
    """A drive without any SYNC, led by SDO: it must do its profiles on its own ticks."""

    def __init__(self, bench: Any, mode: int, **objects: float) -> None:
        self.bench, self.sdo, self.axis = bench, bench.remote.sdo, bench.axis
        self.acted_ns: list[int] = []
        react = bench.node.servo.react
        bench.node.servo.react = lambda now_ns: (self.acted_ns.append(now_ns), react(now_ns))
        self.sdo[0x6060].raw = mode
        self.set(**objects)
        for word in (0x06, 0x07, 0x0F):
            self.sdo[0x6040].raw = word

    def set(self, **objects: float) -> None:
        for name, value in objects.items():
            index, _, sub = name.removeprefix("o").partition("_")
            entry = self.sdo[int(index, 16)]
            (entry[int(sub)] if sub else entry).raw = round(value)

    def word(self, word: int) -> int:
        """Write the controlword; return when it acted."""
        self.sdo[0x6040].raw = word
        return self.acted_ns[-1]

    @property
    def now_ns(self) -> int:
        return int(self.bench.scheduler.now_ns)

    @property
    def status(self) -> int:
        return int(self.sdo[0x6041].raw)

    def at(self, time_ns: int) -> float:
        """Position in m at an instant."""
        self.bench.scheduler.run_until(time_ns)
        self.axis.advance_to(time_ns)
        return float(self.axis.motor_position_m())

    def run_ms(self, time_ms: float) -> None:
        self.bench.scheduler.run_until(self.now_ns + round(time_ms * MS))


@pytest.fixture
def drive(drive_bench: Make) -> Callable[..., Drive]:
    return lambda mode, **objects: Drive(drive_bench(), mode, **objects)


def trapezoid(t: float, way: float, v: float, a: float, d: float) -> float:
    """Position on the way from rest to rest with linear ramps."""
    if way < v * v / 2 * (1 / a + 1 / d):
        v = math.sqrt(2 * way * a * d / (a + d))
    t_a, t_d = v / a, v / d
    t_c = (way - v * v / 2 * (1 / a + 1 / d)) / v
    if t < t_a:
        return a * t * t / 2
    if t < t_a + t_c:
        return v * t_a / 2 + v * (t - t_a)
    rest = max(0.0, t_a + t_c + t_d - t)
    return way - d * rest * rest / 2


def sine(t: float, way: float, v: float, a: float, d: float) -> float:
    """The same with ramps v sin2(pi t / 2T), T = pi v / 2a; the way is long enough for v."""
    t_a, t_d = math.pi * v / 2 / a, math.pi * v / 2 / d
    t_c = way / v - t_a / 2 - t_d / 2
    if t < t_a:
        return v * (t / 2 - t_a / 2 / math.pi * math.sin(math.pi * t / t_a))
    if t < t_a + t_c:
        return v * (t - t_a / 2)
    rest = max(0.0, t_a + t_c + t_d - t)
    return way - v * (rest / 2 - t_d / 2 / math.pi * math.sin(math.pi * rest / t_d))


PROFILE = {"o6081": 0.2 * PER_M, "o6083": 2 * PER_M, "o6084": 4 * PER_M}
RATES = (0.2, 2.0, 4.0)


@pytest.mark.parametrize("way_m", [0.05, 0.01, -0.05])
@pytest.mark.parametrize("shape", [0, 1])
def test_a_set_point_is_reached_on_its_profile(
    drive: Callable[..., Drive], way_m: float, shape: int
) -> None:
    """0.2 m/s, 2 and 4 m/s2; 10 mm are too short for it with linear ramps.

    At each tick the demand lies on the profile, between two ticks on the chord: it is off by
    a T2 / 8 at most, 0.03 um.
    """
    if shape and way_m == 0.01:
        way_m = 0.03
    one = drive(1, **PROFILE, o607A=way_m * PER_M, o6086=shape)
    start_ns = one.word(0x0F | NEW)
    assert one.status & BIT_12
    assert not one.status & REACHED
    form = sine if shape else trapezoid
    for time_ms in (10.0, 40.25, 77.5, 103.0, 155.0, 240.0, 500.0):
        now_ns = start_ns + round(time_ms * MS)
        if now_ns > one.now_ns:
            expected = math.copysign(form(time_ms * 1e-3, abs(way_m), *RATES), way_m)
            assert one.at(now_ns) == pytest.approx(expected, abs=4e-8)
    assert one.status & REACHED
    assert one.axis.commands[-1].enabled


def test_bit_10_comes_with_the_end_of_the_profile_and_the_window_time(
    drive: Callable[..., Drive],
) -> None:
    """50 mm: 0.05/0.2 + 0.1/2 + 0.05/2 = 325 ms; then 6068 = 40 ms within 6067."""
    one = drive(1, **PROFILE, o607A=0.05 * PER_M, o6068=40)
    start_ns = one.word(0x0F | NEW)
    one.at(start_ns + 364 * MS)
    assert not one.bench.node.image.statusword & REACHED
    one.at(start_ns + 366 * MS)
    assert one.bench.node.image.statusword & REACHED


def test_the_handshake_of_bits_4_and_12_and_the_buffer(drive: Callable[..., Drive]) -> None:
    """One set-point runs, one waits; a third one is not taken before the second one runs."""
    one = drive(1, **PROFILE, o607A=0.02 * PER_M)
    assert not one.status & BIT_12
    first_ns = one.word(0x0F | NEW)
    assert one.status & BIT_12
    one.word(0x0F)
    assert not one.status & BIT_12  # the buffer is free
    one.set(o607A=0.03 * PER_M)
    one.word(0x0F | NEW)
    assert one.status & BIT_12
    one.word(0x0F)
    assert one.status & BIT_12  # the buffer is taken
    one.set(o607A=0.04 * PER_M)
    one.word(0x0F | NEW)  # not taken
    one.word(0x0F)
    duration_s = 0.02 / 0.2 + 0.1 / 2 + 0.05 / 2
    one.at(first_ns + round((duration_s + 0.002) * S))
    assert not one.status & BIT_12
    assert not one.status & REACHED  # the second one runs
    one.run_ms(500)
    assert one.axis.motor_position_m() == pytest.approx(0.03, abs=1e-8)
    assert one.status & REACHED


def test_change_at_once_leads_to_the_new_target_without_a_stop(
    drive: Callable[..., Drive],
) -> None:
    """At cruise the new target comes: the speed stays, 80 mm are reached as if ordered at first."""
    one = drive(1, **PROFILE, o607A=0.05 * PER_M)
    start_ns = one.word(0x0F | NEW)
    one.at(start_ns + 150 * MS)
    one.set(o607A=0.08 * PER_M)
    one.word(0x0F)
    one.word(0x0F | NEW | AT_ONCE)
    for time_ms in (200.0, 300.0, 430.0, 470.0, 600.0):
        expected = trapezoid(time_ms * 1e-3, 0.08, *RATES)
        assert one.at(start_ns + round(time_ms * MS)) == pytest.approx(expected, abs=1e-7)


def test_change_at_once_to_a_target_behind_stops_and_turns(drive: Callable[..., Drive]) -> None:
    """At 0.2 m/s, 20 mm on the way: it stops after v2/2d = 5 mm more, then goes back."""
    one = drive(1, **PROFILE, o607A=0.2 * PER_M)
    start_ns = one.word(0x0F | NEW)
    one.at(start_ns + 150 * MS)
    one.set(o607A=0.01 * PER_M)
    one.word(0x0F)
    turn_ns = one.word(0x0F | NEW | AT_ONCE)
    begin_m = trapezoid((turn_ns - start_ns) * 1e-9, 0.2, *RATES)
    peak_m = one.at(turn_ns + 50 * MS)
    assert peak_m == pytest.approx(begin_m + 0.2**2 / 2 / 4, abs=1e-7)
    back_m = peak_m - 0.01
    expected = peak_m - trapezoid(0.08, back_m, *RATES)
    assert one.at(turn_ns + 130 * MS) == pytest.approx(expected, abs=1e-7)
    one.run_ms(400)
    assert one.axis.motor_position_m() == pytest.approx(0.01, abs=1e-8)


def test_relative_set_points_count_from_the_last_target(drive: Callable[..., Drive]) -> None:
    one = drive(1, **PROFILE, o607A=0.01 * PER_M)
    for _ in range(2):
        one.word(0x0F | NEW | RELATIVE)
        one.word(0x0F | RELATIVE)
        one.run_ms(20)  # the first is still running when the second comes
    one.run_ms(600)
    assert one.axis.motor_position_m() == pytest.approx(0.02, abs=1e-8)


def test_halt_in_pp_stops_and_the_set_point_goes_on_afterwards(
    drive: Callable[..., Drive],
) -> None:
    one = drive(1, **PROFILE, o607A=0.05 * PER_M)
    start_ns = one.word(0x0F | NEW)
    one.at(start_ns + 150 * MS)
    halt_ns = one.word(0x0F | NEW | HALT)
    begin_m = trapezoid((halt_ns - start_ns) * 1e-9, 0.05, *RATES)
    one.at(halt_ns + 40 * MS)
    assert not one.status & REACHED
    stand_m = one.at(halt_ns + 100 * MS)
    assert stand_m == pytest.approx(begin_m + 0.2**2 / 2 / 4, abs=1e-7)
    assert one.status & REACHED  # with halt: it stands
    assert one.bench.node.state is State.OPERATION_ENABLED
    one.word(0x0F | NEW)
    one.run_ms(500)
    assert one.axis.motor_position_m() == pytest.approx(0.05, abs=1e-8)


@pytest.mark.parametrize(
    ("limit", "value", "speed_m_s"),
    [("o607F", 0.1 * PER_M, 0.1), ("o6080", 300, 0.05), ("o6080", 0xFFFFFFFF, 0.2)],
)
def test_speed_of_a_profile_is_limited_by_607f_and_6080(
    drive: Callable[..., Drive], limit: str, value: float, speed_m_s: float
) -> None:
    """300 rev/min of a 10 mm screw are 50 mm/s; bit 11 tells of the limit."""
    one = drive(1, **PROFILE, **{limit: value}, o607A=0.05 * PER_M)
    start_ns = one.word(0x0F | NEW)
    expected = trapezoid(0.15, 0.05, speed_m_s, *RATES[1:])
    assert one.at(start_ns + 150 * MS) == pytest.approx(expected, abs=1e-7)
    assert bool(one.status & LIMITED) == (speed_m_s < 0.2)


def test_accelerations_of_a_profile_are_limited_by_60c5_and_60c6(
    drive: Callable[..., Drive],
) -> None:
    one = drive(1, **PROFILE, o60C5=1 * PER_M, o60C6=2 * PER_M, o607A=0.1 * PER_M)
    start_ns = one.word(0x0F | NEW)
    for time_s in (0.1, 0.3, 0.55, 0.6):
        expected = trapezoid(time_s, 0.1, 0.2, 1.0, 2.0)
        assert one.at(start_ns + round(time_s * S)) == pytest.approx(expected, abs=1e-7)


def test_software_limits_stop_a_set_point(drive: Callable[..., Drive]) -> None:
    one = drive(1, **PROFILE, o607D_1=-0.01 * PER_M, o607D_2=0.03 * PER_M, o607A=0.05 * PER_M)
    one.word(0x0F | NEW)
    one.run_ms(400)
    assert one.axis.motor_position_m() == pytest.approx(0.03, abs=1e-8)
    assert one.status & LIMITED
    one.set(o607D_1=0, o607D_2=0)  # min not below max: off
    one.word(0x0F)
    one.word(0x0F | NEW)
    one.run_ms(400)
    assert one.axis.motor_position_m() == pytest.approx(0.05, abs=1e-8)
    assert not one.status & LIMITED


@pytest.mark.parametrize(
    ("leave", "wait_ms"), [({"o6040": 0x07}, 100), ({"o6060": 3}, 100), ({"o6060": 3}, 2)]
)
def test_set_points_that_ran_or_waited_are_forgotten_when_the_mode_begins_anew(
    drive: Callable[..., Drive], leave: dict[str, float], wait_ms: float
) -> None:
    """Power off and on, another mode and back, at rest or on the way to it.

    The axis comes to rest and stands until it is given a new one.
    """
    one = drive(1, **PROFILE, o607A=0.05 * PER_M)
    one.word(0x0F | NEW)
    one.word(0x0F)
    one.set(o607A=0.08 * PER_M)
    one.word(0x0F | NEW)
    one.word(0x0F)
    one.run_ms(100)
    one.set(**leave)
    one.run_ms(wait_ms)
    one.set(o6060=1, o6040=0x0F)
    one.run_ms(100)
    stand_m = one.axis.motor_position_m()
    assert 0.0 < stand_m < 0.03
    one.run_ms(800)
    assert one.axis.motor_position_m() == pytest.approx(stand_m, abs=1e-8)
    assert one.status & (REACHED | BIT_12) == REACHED
    one.set(o607A=0.01 * PER_M)
    one.word(0x0F | NEW)
    one.run_ms(500)
    assert one.axis.motor_position_m() == pytest.approx(0.01, abs=1e-8)
    assert one.status & REACHED


# Profile velocity


def test_pv_ramps_to_its_target_and_through_zero(drive: Callable[..., Drive]) -> None:
    """0 -> 0.1 m/s with 2 m/s2 (50 ms), -> -0.2 m/s: 25 ms with 4 m/s2, 100 ms with 2 m/s2."""
    one = drive(3, **PROFILE)
    one.run_ms(5)
    assert one.status & BIT_12  # stands
    one.set(o60FF=0.1 * PER_M)
    one.run_ms(100)
    assert one.sdo[0x606C].raw == pytest.approx(0.1 * PER_M, abs=1)
    assert one.status & (REACHED | BIT_12) == REACHED
    here_ns = one.now_ns
    here_m = one.at(here_ns)
    assert one.at(here_ns + 40 * MS) == pytest.approx(here_m + 0.1 * 0.04, abs=1e-9)
    one.set(o60FF=-0.2 * PER_M)
    turn = one.axis.commands[-1]
    begin_m, begin_ns = turn.position_m, turn.time_ns
    ticks = [0.02, 0.025, 0.05, 0.1, 0.125]
    for time_s in ticks:
        if time_s <= 0.025:
            expected = (0.1 - 2 * time_s) * time_s
        else:
            expected = 0.1 * 0.025 / 2 - (time_s - 0.025) ** 2
        now_ns = begin_ns + round(time_s * S)
        if now_ns > one.now_ns:
            # The target acts at the next tick: up to 250 us late
            assert one.at(now_ns) == pytest.approx(begin_m + expected, abs=0.25e-3 * 0.3)
    one.run_ms(50)
    assert one.sdo[0x606C].raw == pytest.approx(-0.2 * PER_M, abs=1)


def test_pv_acceleration_takes_v_by_a(drive: Callable[..., Drive]) -> None:
    """Bit 10 with a window of 1 unit/s and 606E = 0: at the tick that ends the ramp of 50 ms."""
    one = drive(3, **PROFILE, o606D=1)
    one.set(o60FF=0.1 * PER_M)
    moving = [c for c in one.axis.commands if c.velocity_m_s]
    begin_ns = moving[0].time_ns
    one.at(begin_ns + 49 * MS)
    assert not one.bench.node.image.statusword & REACHED
    one.at(begin_ns + 51 * MS)
    assert one.bench.node.image.statusword & REACHED


def test_pv_stops_exactly_at_a_software_limit(drive: Callable[..., Drive]) -> None:
    one = drive(3, **PROFILE, o607D_1=-0.01 * PER_M, o607D_2=0.02 * PER_M, o60FF=0.1 * PER_M)
    one.run_ms(400)
    assert one.axis.motor_position_m() == pytest.approx(0.02, abs=1e-8)
    assert one.status & LIMITED
    one.set(o60FF=-0.1 * PER_M)
    one.run_ms(600)
    assert one.axis.motor_position_m() == pytest.approx(-0.01, abs=1e-8)


@pytest.mark.parametrize(
    ("changed", "speed_m_s"),
    [
        ({"o607F": 0.05 * PER_M}, 0.05),
        ({"o6080": 120}, 0.02),  # rev/min of a screw with 10 mm
        ({"o607D_1": -0.01 * PER_M, "o607D_2": 0.03 * PER_M}, 0.0),
    ],
)
def test_a_limit_that_is_set_while_an_axis_moves_with_pv_acts_from_then_on(
    drive: Callable[..., Drive], changed: dict[str, float], speed_m_s: float
) -> None:
    """With 0.1 m/s it is at 17.5 mm after 200 ms; bit 11 says that it is limited."""
    one = drive(3, **PROFILE, o60FF=0.1 * PER_M)
    one.run_ms(190)
    assert not one.status & LIMITED
    one.set(**changed)
    one.run_ms(300)
    assert one.sdo[0x606C].raw == pytest.approx(speed_m_s * PER_M, abs=1)
    assert one.status & LIMITED
    if not speed_m_s:
        assert one.axis.motor_position_m() == pytest.approx(0.03, abs=1e-8)
    one.set(o607F=PER_M, o6080=0xFFFFFFFF, o607D_1=0, o607D_2=0)
    one.run_ms(200)
    assert one.sdo[0x606C].raw == pytest.approx(0.1 * PER_M, abs=1)
    assert not one.status & LIMITED


def test_ramps_that_change_while_an_axis_follows_them_with_pv_act_from_then_on(
    drive: Callable[..., Drive],
) -> None:
    """To 0.4 m/s with 2 m/s2 for 50 ms, then with 4: there 75 ms later; down with 8 m/s2 in 50."""
    one = drive(3, **PROFILE, o60FF=0.4 * PER_M)
    one.run_ms(50)
    one.set(o6083=4 * PER_M)
    one.run_ms(70)
    assert 0.36 * PER_M < one.sdo[0x606C].raw < 0.4 * PER_M
    one.run_ms(10)
    assert one.sdo[0x606C].raw == pytest.approx(0.4 * PER_M, abs=1)
    one.set(o60FF=0.0)
    one.set(o6084=8 * PER_M)
    one.run_ms(55)
    assert one.sdo[0x606C].raw == 0


# Changes of mode


def test_an_unknown_mode_is_refused_by_sdo_and_not_followed_from_a_pdo(
    drive_bench: Make,
) -> None:
    bench = drive_bench()
    sdo = bench.remote.sdo
    sdo[0x1401][1].raw = 0x80000303
    sdo[0x1601][1].raw, sdo[0x1601][0].raw = 0x60600008, 1
    sdo[0x1401][1].raw = 0x303
    bench.operational(30)
    for mode, display in ((3, 3), (5, 3), (-1, 3), (1, 1), (8, 8)):
        bench.master.send_message(0x303, mode.to_bytes(1, "little", signed=True))
        bench.sync_at_ms(bench.scheduler.now_ns // MS + 1)
        assert sdo[0x6061].raw == display


@pytest.mark.parametrize("mode", [1, 3])
def test_a_mode_of_positions_takes_a_moving_axis_over_without_a_jump(
    drive_bench: Make, mode: int
) -> None:
    """Csp at 100 mm/s, then pp or pv: it goes on from there and slows down with 1 m/s2."""
    bench = drive_bench()
    bench.remote.sdo[0x6084].raw = PER_M
    bench.operational()
    bench.enable(4)
    for n in range(1, 50):
        bench.set_values(0x0F, round(n * PER_M * 1e-4))
        bench.sync_at_ms(7 + n)
    bench.remote.sdo[0x6060].raw = mode
    first = next(i for i, c in enumerate(bench.axis.commands) if c.time_ns > 56 * MS + 100 * US)
    turn = bench.axis.commands[first]
    assert turn.position_m == pytest.approx(
        bench.axis.commands[first - 1].position_m
        + 0.1 * (turn.time_ns - bench.axis.commands[first - 1].time_ns) * 1e-9, abs=1e-8
    )  # fmt: skip
    bench.scheduler.run_until(turn.time_ns + 40 * MS)
    bench.axis.advance_to(turn.time_ns + 40 * MS)
    expected = turn.position_m + 0.1 * 0.04 - 0.04**2 / 2
    assert bench.axis.motor_position_m() == pytest.approx(expected, abs=3e-5)
    assert bench.remote.sdo[0x6061].raw == mode


def test_csp_keeps_the_course_of_a_moving_axis_for_one_period(drive: Callable[..., Drive]) -> None:
    """Pv at 0.1 m/s, then csp by SDO: 607A is where the demand is one period later."""
    one = drive(3, **PROFILE, o60FF=0.1 * PER_M)
    one.run_ms(100)
    one.set(o6060=8)
    last = one.axis.commands[-1]
    assert last.velocity_m_s == pytest.approx(0.1)
    assert last.end_ns - last.time_ns == 1 * MS
    assert one.sdo[0x607A].raw == round((last.position_m + 0.1e-3) * PER_M)


def test_an_axis_under_velocity_control_is_stopped_before_it_is_positioned(
    drive: Callable[..., Drive],
) -> None:
    """Csv at 0.1 m/s, then csp: 25 ms with 4 m/s2, and 6061 shows 9 until it stands."""
    one = drive(9, **PROFILE, o60FF=0.1 * PER_M)
    one.bench.master.send_message(0x80, b"")
    one.run_ms(20)
    one.set(o6060=8)
    begin_ns = one.axis.commands[-1].time_ns
    assert one.axis.commands[-1].kind is ControlKind.VELOCITY
    assert one.sdo[0x6061].raw == 9
    one.at(begin_ns + 24 * MS)
    assert one.bench.node.image.mode_display == 9
    one.at(begin_ns + 26 * MS)
    assert one.bench.node.image.mode_display == 8
    assert one.axis.commands[-1].kind is ControlKind.POSITION


def test_6502_follows_the_plant_and_so_do_modes_and_option_codes(
    drive_bench: Make, fake_axis: Any
) -> None:
    axis = fake_axis()
    axis.kinds = frozenset({ControlKind.POSITION})
    bench = drive_bench(axis)
    bits = bench.remote.sdo[0x6502].raw
    assert bits & 0x385 == 0x085  # pp, pv, csp; neither csv nor cst
    for index, value in ((0x6060, 9), (0x6060, 10), (0x605A, 3), (0x605A, 8), (0x605E, 4)):
        with pytest.raises(SdoAbortedError) as caught:
            bench.remote.sdo[index].raw = value
        assert caught.value.code == 0x06090030
    assert drive_bench().remote.sdo[0x6502].raw & 0x385 == 0x385
