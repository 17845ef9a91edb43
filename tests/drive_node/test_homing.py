"""Homing: where each method finds home, what the statusword says, and how it fails."""

from bisect import bisect_left

import pytest

from bench.drive.application.servo import Servo
from bench.drive.ports import ControlKind
from bench.drive.profile import DriveProfile
from kernel.clock import MS, US
from kernel.cosim.scheduler import Scheduler
from kernel.drives.ds402 import State

UNITS_PER_MM = 2**20 / 10
LOOK_NS = 125 * US
# mm: the ends of the way, the cam of the home switch, switches that reach to an end; marks of the
# zero pulse at 2.5 mm in every revolution of 10 mm
LIMITS, CAM, UPPER, LOWER = (-50.0, 60.0), (12.0, 18.0), 13.0, -13.0
TICK_S, FAST, SLOW = 250e-6, 50.0, 5.0  # s, mm/s
ATTAINED, REACHED, ERROR, LIMITED = 1 << 12, 1 << 10, 1 << 13, 1 << 11
BITS = ATTAINED | REACHED | ERROR


class Switch:
    """A switch that is on in a range of the axis, known every 125 us."""

    def __init__(self, low_mm: float, high_mm: float) -> None:
        self.low_mm, self.high_mm = low_mm, high_mm
        self.level = False
        self.edges: list[tuple[int, bool]] = []

    def look(self, time_ns: int, position_mm: float) -> None:
        level = self.low_mm <= position_mm <= self.high_mm
        if level != self.level and time_ns:
            self.edges.append((time_ns, level))
        self.level = level


class Axis:
    """An axis that follows its demand exactly as far as nothing is in the way, and knows its past.

    wall_mm: a stop in positive direction. force_n: None = the plant tells no force.
    """

    kinds = frozenset({ControlKind.POSITION})
    limits_force = True

    def __init__(self, start_mm: float, switches: list[Switch], wall_mm: float = 1e9) -> None:
        self.switches, self.wall_m = switches, wall_mm * 1e-3
        self.now_ns = 0
        self.ramp = (0, start_mm * 1e-3, 0.0, 0)
        self.times, self.past = [0], [start_mm * 1e-3]
        self.limits_n: list[tuple[float, float]] = []
        self.is_on = False
        for switch in switches:
            switch.look(0, start_mm)

    def advance_to(self, time_ns: int) -> None:
        while self.now_ns < time_ns:
            self.now_ns = min(time_ns, (self.now_ns // LOOK_NS + 1) * LOOK_NS)
            place_m = min(self.demand_position_m(), self.wall_m)
            self.times.append(self.now_ns)
            self.past.append(place_m)
            for switch in self.switches:
                switch.look(self.now_ns, place_m * 1e3)

    def command(
        self, time_ns: int, position_m: float, velocity_m_s: float, end_ns: int, enabled: bool
    ) -> None:
        self.ramp = (time_ns, position_m, velocity_m_s, end_ns)
        self.is_on = enabled

    def demand_position_m(self) -> float:
        begin_ns, position_m, velocity_m_s, end_ns = self.ramp
        return position_m + velocity_m_s * (min(self.now_ns, end_ns) - begin_ns) * 1e-9

    def motor_position_m(self) -> float:
        return self.past[-1]

    def motor_velocity_m_s(self) -> float:
        if len(self.past) < 2:
            return 0.0
        return (self.past[-1] - self.past[-2]) / (self.times[-1] - self.times[-2]) * 1e9

    def motor_position_m_at(self, time_ns: int) -> float:
        k = bisect_left(self.times, time_ns)
        if self.times[k] == time_ns:
            return self.past[k]
        share = (time_ns - self.times[k - 1]) / (self.times[k] - self.times[k - 1])
        return self.past[k - 1] + share * (self.past[k] - self.past[k - 1])

    def limit_force(self, negative_n: float, positive_n: float) -> None:
        self.limits_n.append((negative_n, positive_n))

    def force_n(self) -> float | None:
        return None

    def second_encoder_m(self) -> float | None:
        return None


class Bench:
    """A servo in operation in mode 6, without a bus; its ticks come by themselves."""

    def __init__(
        self,
        start_mm: float,
        switches: dict[str, Switch] | None = None,
        wall_mm: float = 1e9,
        **habits: object,
    ) -> None:
        switches = switches or {}
        self.scheduler = Scheduler()
        self.axis = Axis(start_mm, list(switches.values()), wall_mm)
        profile = DriveProfile(index_angle_deg=90.0, **habits)  # type: ignore[arg-type]
        self.emergencies: list[int] = []
        self.servo = Servo(
            self.axis,
            (None, None),
            profile,
            lambda code, register, info: self.emergencies.append(code),
            self.scheduler,
            lambda: None,
            0,
            switches,
        )
        self.servo.reset(0)
        self.image = self.servo.image
        self.image.homing_speed_switch = round(FAST * UNITS_PER_MM)
        self.image.homing_speed_zero = round(SLOW * UNITS_PER_MM)
        self.enable()

    def enable(self) -> None:
        """Walk to operation enabled in mode 6."""
        self.write(mode=6)
        for word in (0x06, 0x07, 0x0F):
            self.write(controlword=word)
        assert self.servo.state is State.OPERATION_ENABLED
        self.run_ms(2)

    def write(self, **values: int) -> None:
        now_ns = self.scheduler.now_ns
        self.servo.begin(now_ns)
        for name, value in values.items():
            setattr(self.image, name, value)
        self.servo.update()
        self.servo.react(now_ns)

    def run_ms(self, duration_ms: float) -> None:
        self.scheduler.run_until(self.scheduler.now_ns + round(duration_ms * MS))
        self.servo.refresh(self.scheduler.now_ns)

    @property
    def bits(self) -> int:
        return self.image.statusword & BITS

    @property
    def place_mm(self) -> float:
        return self.axis.motor_position_m() * 1e3

    def home(self, method: int, limit_s: float = 20.0) -> float:
        """Run a method to its end; return where the machine lies that the drive calls 0 (mm)."""
        self.write(homing_method=method, controlword=0x1F)
        for _ in range(round(limit_s * 100)):
            self.run_ms(10)
            if self.bits & REACHED:
                break
        assert self.bits & REACHED, "homing did not end"
        return self.place_mm - self.image.position_actual / UNITS_PER_MM


def bench_for(method: int, start_mm: float, **habits: object) -> Bench:
    """Limit switches, and the home switch that the method is made for."""
    kind = (method - 1) % 16 + 1 if 0 < method <= 30 else 0
    ranges = {3: (UPPER, 1e9), 4: (UPPER, 1e9), 5: (-1e9, LOWER), 6: (-1e9, LOWER)}
    switches = {
        "negative": Switch(-1e9, LIMITS[0]),
        "positive": Switch(LIMITS[1], 1e9),
        "home": Switch(*ranges.get(kind, CAM)),
    }
    return Bench(start_mm, switches, **habits)


# Where home lies (mm), from the figures of CiA 402-2 for this machine; edge of the switch or mark
EDGES = {
    17: -50.0, 18: 60.0, 19: 13.0, 20: 13.0, 21: -13.0, 22: -13.0,
    23: 12.0, 24: 12.0, 25: 18.0, 26: 18.0, 27: 18.0, 28: 18.0, 29: 12.0, 30: 12.0,
}  # fmt: skip
MARKS = {
    1: -47.5, 2: 52.5, 3: 12.5, 4: 22.5, 5: -7.5, 6: -17.5,
    7: 2.5, 8: 12.5, 9: 12.5, 10: 22.5, 11: 22.5, 12: 12.5, 13: 12.5, 14: 2.5,
}  # fmt: skip
STARTS = {
    **dict.fromkeys((1, 2, 17, 18), (-49.0, 0.0, 59.0)),
    **dict.fromkeys((3, 4, 19, 20), (-20.0, 12.9, 13.1, 30.0)),
    **dict.fromkeys((5, 6, 21, 22), (20.0, -12.9, -13.1, -30.0)),
    **dict.fromkeys((*range(7, 15), *range(23, 31)), (-20.0, 11.9, 12.1, 17.9, 18.1, 40.0)),
}
# From the edge at the switch to the tick that sees it, at the slow speed; input delay, resolution
SEEN_MM = SLOW * (TICK_S + 4e-6 + LOOK_NS * 1e-9) + 1 / UNITS_PER_MM


@pytest.mark.parametrize(("method", "start_mm"), [(m, s) for m in EDGES for s in STARTS[m]])
def test_home_is_the_edge_of_the_switch(method: int, start_mm: float) -> None:
    """Within slow speed times tick, from wherever it begins."""
    bench = bench_for(method, start_mm)
    found_mm = bench.home(method)
    assert bench.bits == ATTAINED | REACHED
    assert found_mm == pytest.approx(EDGES[method], abs=SEEN_MM)


@pytest.mark.parametrize(("method", "start_mm"), [(m, s) for m in MARKS for s in STARTS[m][::2]])
def test_home_is_the_zero_pulse_beside_the_switch(method: int, start_mm: float) -> None:
    """To the increment: whole revolutions from the mark of the encoder."""
    bench = bench_for(method, start_mm)
    found_mm = bench.home(method)
    assert bench.bits == ATTAINED | REACHED
    assert found_mm == pytest.approx(MARKS[method], abs=1.01 / UNITS_PER_MM)


@pytest.mark.parametrize(
    ("method", "start_mm", "home_mm"), [(33, 7.0, 2.5), (34, 7.0, 12.5), (33, -1.0, -7.5)]
)
def test_home_is_the_next_zero_pulse(method: int, start_mm: float, home_mm: float) -> None:
    assert Bench(start_mm).home(method) == pytest.approx(home_mm, abs=1.01 / UNITS_PER_MM)


@pytest.mark.parametrize("method", [35, 37])
def test_home_is_where_the_axis_stands(method: int) -> None:
    bench = Bench(7.0)
    assert bench.home(method) == pytest.approx(7.0, abs=1 / UNITS_PER_MM)
    assert bench.place_mm == 7.0


@pytest.mark.parametrize(("method", "home_mm"), [(-3, 25.0), (-1, 22.5)])
def test_home_is_a_stop_or_the_zero_pulse_before_it(method: int, home_mm: float) -> None:
    """The stop is felt by standstill; while it is pressed the torque is limited."""
    bench = Bench(0.0, wall_mm=25.0, homing_torque=300)
    assert bench.home(method) == pytest.approx(home_mm, abs=1.01 / UNITS_PER_MM)
    assert bench.bits == ATTAINED | REACHED
    pressed_n, free_n = bench.axis.limits_n[0], bench.axis.limits_n[-1]
    rated_n = 2.2 * 2 * 3.141592653589793 / 0.01
    assert pressed_n == pytest.approx((0.3 * rated_n, 0.3 * rated_n))
    assert min(free_n) > 60 * rated_n


def test_a_stop_that_is_pressed_makes_no_following_error_an_obstacle_on_the_way_does() -> None:
    """6065 = 0.5 mm: monitored on the way to a switch, not while the axis is pressed to a stop."""
    window = round(0.5 * UNITS_PER_MM)
    bench = Bench(0.0, wall_mm=25.0, homing_torque=300)
    bench.write(following_window=window, following_timeout_ms=0)
    bench.home(-3)
    assert bench.bits == ATTAINED | REACHED
    assert bench.emergencies == []
    bench = Bench(0.0, {"positive": Switch(LIMITS[1], 1e9)}, wall_mm=25.0)
    bench.write(following_window=window, following_timeout_ms=0)
    bench.write(homing_method=18, controlword=0x1F)
    bench.run_ms(3000)
    assert bench.emergencies == [0x8611]


# What the statusword says


def test_bits_tell_how_far_homing_is() -> None:
    """CiA 402-2: 0 0 1 not started, 0 0 0 under way, 0 1 0 attained, 0 1 1 attained and at rest."""
    bench = Bench(7.0)
    assert bench.bits == REACHED
    bench.write(homing_method=34, controlword=0x1F)
    assert bench.bits == 0
    seen = []
    for _ in range(40_000):
        bench.run_ms(0.25)
        if not seen or seen[-1] != bench.bits:
            seen.append(bench.bits)
        if bench.bits & REACHED:
            break
    assert seen == [0, ATTAINED, ATTAINED | REACHED]
    bench.write(controlword=0x0F)
    bench.run_ms(5)
    assert bench.bits == ATTAINED | REACHED


def test_bit_4_taken_away_interrupts() -> None:
    bench = Bench(7.0)
    bench.write(homing_method=33, controlword=0x1F)
    bench.run_ms(100)
    assert bench.bits == 0
    bench.write(controlword=0x0F)
    bench.run_ms(200)
    place_mm = bench.place_mm
    bench.run_ms(500)
    assert bench.bits == REACHED
    assert bench.place_mm == place_mm > 2.5


def test_halt_stops_and_homing_goes_on_after_it() -> None:
    bench = bench_for(19, 0.0)
    bench.write(homing_method=19, controlword=0x1F)
    bench.run_ms(100)
    bench.write(controlword=0x11F)
    bench.run_ms(300)
    place_mm = bench.place_mm
    bench.run_ms(300)
    assert bench.bits == REACHED
    assert bench.place_mm == place_mm < UPPER
    bench.write(controlword=0x1F)
    bench.run_ms(5000)
    assert bench.bits == ATTAINED | REACHED
    found_mm = bench.place_mm - bench.image.position_actual / UNITS_PER_MM
    assert found_mm == pytest.approx(13.0, abs=SEEN_MM)


def test_a_reference_stays_when_the_mode_is_left_and_entered_again() -> None:
    bench = Bench(7.0)
    bench.home(34)
    bench.write(mode=1, controlword=0x0F)
    bench.run_ms(5)
    bench.write(mode=6)
    bench.run_ms(5)
    assert bench.bits == ATTAINED | REACHED


def test_power_off_breaks_it_off() -> None:
    bench = Bench(7.0)
    bench.write(homing_method=33, controlword=0x1F)
    bench.run_ms(100)
    bench.write(controlword=0x00)
    assert not bench.axis.is_on
    for word in (0x06, 0x07, 0x0F):
        bench.write(controlword=word)
    bench.run_ms(5)
    assert bench.bits == REACHED


# Where the zero lies


@pytest.mark.parametrize(("habit", "at_home"), [("zero", -100_000), ("value", 100_000)])
def test_home_offset(habit: str, at_home: int) -> None:
    """CiA 402: the zero lies 607C above home, which so lies at -607C; some drives: home is 607C."""
    bench = Bench(7.0, home_offset=habit)
    bench.write(home_offset=100_000)
    bench.home(37)
    assert bench.image.position_actual == at_home


def test_offset_acts_with_the_next_homing_only() -> None:
    bench = Bench(7.0)
    before = bench.image.position_actual
    bench.write(home_offset=100_000)
    bench.run_ms(5)
    assert bench.image.position_actual == before


@pytest.mark.parametrize("offset", [0, 100_000])
def test_software_limits_count_from_home(offset: int) -> None:
    """607D is relative to the machine home position, whatever the zero: 20 mm above it, 27 mm."""
    bench = Bench(7.0)
    bench.write(home_offset=offset, software_limit_min=-100, software_limit_max=20 * 104_858)
    bench.home(37)
    bench.write(mode=1, controlword=0x0F, target_position=2**30)
    bench.run_ms(2)
    bench.write(controlword=0x3F)
    bench.run_ms(5000)
    assert bench.place_mm == pytest.approx(27.0, abs=1e-4)
    assert bench.image.statusword & LIMITED


def test_reset_forgets_the_reference() -> None:
    bench = Bench(7.0)
    bench.home(37)
    bench.servo.reset(bench.scheduler.now_ns)
    assert bench.image.position_actual == round(7.0 * UNITS_PER_MM)
    bench.enable()
    assert bench.bits == REACHED


def test_another_position_unit_forgets_the_reference() -> None:
    """The zero was counted in the old one."""
    bench = Bench(7.0)
    bench.write(home_offset=100_000)
    bench.home(37)
    bench.write(controlword=0)
    bench.write(feed=10_000)
    assert bench.image.position_actual == 7000
    bench.enable()
    assert bench.bits == REACHED


def test_reset_at_the_stop_lifts_its_torque_limit() -> None:
    bench = Bench(0.0, wall_mm=2.0)
    bench.write(homing_method=-3, controlword=0x1F)
    bench.run_ms(80)
    assert bench.axis.limits_n[-1][1] < 1000
    bench.servo.reset(bench.scheduler.now_ns)
    assert bench.axis.limits_n[-1][1] > 60_000


# How it fails


def failed(bench: Bench, method: int) -> float:
    bench.home(method)
    assert bench.bits == ERROR | REACHED
    assert bench.emergencies == []
    return bench.place_mm


@pytest.mark.parametrize("method", [3, 19])
def test_limit_switch_in_the_way_is_an_error(method: int) -> None:
    switches = {
        "negative": Switch(-1e9, -50.0),
        "positive": Switch(60.0, 1e9),
        "home": Switch(70.0, 1e9),
    }
    place_mm = failed(Bench(0.0, switches), method)
    # v dt until it is seen, then v2/2a with the homing acceleration of 1000 mm/s2
    assert 60.0 < place_mm < 60.0 + FAST * 0.5e-3 + FAST**2 / 2000 + 1e-3


@pytest.mark.parametrize("method", [7, 11, 23])
def test_home_switch_that_is_nowhere_is_looked_for_between_both_limits(method: int) -> None:
    switches = {
        "negative": Switch(-1e9, -5.0),
        "positive": Switch(6.0, 1e9),
        "home": Switch(70.0, 71.0),
    }
    bench = Bench(0.0, switches)
    place_mm = failed(bench, method)
    beyond_mm = FAST**2 / 2000  # 609A is 1000 mm/s2
    expected_mm = 6.0 + beyond_mm if method == 11 else -5.0 - beyond_mm
    assert place_mm == pytest.approx(expected_mm, abs=FAST * 0.5e-3)
    travelled_mm = [p * 1e3 for p in bench.axis.past]
    assert min(travelled_mm) < -5.0 < 6.0 < max(travelled_mm)


def test_both_limits_at_once_are_an_error() -> None:
    switches = {"negative": Switch(-1e9, 1e9), "positive": Switch(-1e9, 1e9), "home": Switch(5, 9)}
    assert failed(Bench(0.0, switches), 23) == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("method", [1, 2, 3, 17, 30])
def test_switch_that_is_not_wired_is_an_error_at_once(method: int) -> None:
    assert failed(Bench(7.0), method) == 7.0


def test_blocked_axis_is_an_error() -> None:
    assert failed(Bench(0.0, {"home": Switch(50.0, 60.0)}, wall_mm=20.0), 19) == pytest.approx(20.0)


def test_a_new_start_clears_the_error() -> None:
    bench = Bench(7.0)
    failed(bench, 17)
    bench.write(controlword=0x0F)
    bench.home(37)
    assert bench.bits == ATTAINED | REACHED


@pytest.mark.parametrize("method", [0, 15, 16, 31, 32, 36, 40, -5])
def test_unknown_method_by_pdo_is_an_error(method: int) -> None:
    assert failed(Bench(7.0), method) == 7.0
