"""The machine that homing is tried on: an axis with switches and stops, and a servo in mode 6."""

from bisect import bisect_left

from axisrig.bench.drive.axis.ports import ControlKind
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.servo import Servo
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

UNITS_PER_MM = 2**20 / 10
LOOK_NS = 125 * US
# mm: the ends of the way, the cam of the home switch, switches that reach to an end; marks of the
# zero pulse at 2.5 mm in every revolution of 10 mm
LIMITS, CAM, UPPER, LOWER = (-50.0, 60.0), (12.0, 18.0), 13.0, -13.0
TICK_S, FAST, SLOW = 250e-6, 50.0, 5.0  # s, mm/s
ATTAINED, REACHED, ERROR, LIMITED = 1 << 12, 1 << 10, 1 << 13, 1 << 11
HALT, GO_ON = 0x11F, 0x1F
"""Control words of homing that is halted (bit 8), and of one that runs."""
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

    wall_mm, floor_mm: stops in positive and negative direction. force_n: None = the plant reports
    no force.
    """

    kinds = frozenset({ControlKind.POSITION})
    limits_force = True

    def __init__(
        self,
        start_mm: float,
        switches: list[Switch],
        wall_mm: float = 1e9,
        floor_mm: float = -1e9,
    ) -> None:
        self.switches, self.wall_m, self.floor_m = switches, wall_mm * 1e-3, floor_mm * 1e-3
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
            place_m = max(self.floor_m, min(self.demand_position_m(), self.wall_m))
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
        floor_mm: float = -1e9,
        **habits: object,
    ) -> None:
        switches = switches or {}
        self.scheduler = new_scheduler()
        self.axis = Axis(start_mm, list(switches.values()), wall_mm, floor_mm)
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


def found_after_halt_mm(bench: Bench) -> float:
    """Let it go on to the end; return where home is."""
    bench.write(controlword=GO_ON)
    for _ in range(500):
        bench.run_ms(10)
        if bench.bits & REACHED:
            break
    assert bench.bits == ATTAINED | REACHED
    return bench.place_mm - bench.image.position_actual / UNITS_PER_MM


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


# From the edge at the switch to the tick that reads it, at the slow speed; input delay, resolution
LATE_MM = SLOW * (TICK_S + 4e-6 + LOOK_NS * 1e-9) + 1 / UNITS_PER_MM
