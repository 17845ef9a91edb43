"""Homing and limit switches on the shipped rig, led by a plain master, against the plant."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from axisrig.bench.bus.can.canopen_sim import SimNetwork, SimRemoteNode
from axisrig.bench.bus.journal import Journal
from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.machine.canopen.nodes import build_nodes, build_segments
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.machine.plants import build_plant, check_plants, start_plant
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import as_written, read_settings
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

RIG = Path("testplans/rigs/homing-z.toml")
UNITS_PER_MM = 2**20 / 10
SLOW_MM_S = 5.0
# From the edge to the tick that reads it, at the slow speed: tick and input delay
LATE_MM = SLOW_MM_S * (250e-6 + 4e-6) + 1 / UNITS_PER_MM
ATTAINED, REACHED, ERROR, LIMITED = 1 << 12, 1 << 10, 1 << 13, 1 << 11


class Master:
    """A master that knows canopen alone; it reads the plant's truth beside the bus."""

    def __init__(self, assignments: tuple[str, ...], opened: ExitStack) -> None:
        table, files = read_rig(RIG)
        changes = [(parse_assignment(text), as_written) for text in assignments]
        settings = read_settings(table, files, changes)
        self.scheduler = new_scheduler()
        self.plant = build_plant(settings)
        opened.callback(self.plant.close)
        check_plants(settings, self.plant)
        start_plant(settings, self.plant)
        segments = build_segments(settings, self.scheduler, Journal(), (), opened)
        self.node = build_nodes(
            settings, self.scheduler, segments, Beside(settings, self.plant, self.scheduler), 0
        )["Z"]
        network = self.network = SimNetwork(segments["can1"].port("master")).connect()
        remote = SimRemoteNode(3, object_dictionary(3, self.node.profile))
        network.add_node(remote)
        self.emergencies: list[int] = []
        network.subscribe(0x83, lambda _, data, __: self.emergencies.append(data[0] | data[1] << 8))
        self.sdo = remote.sdo
        self.run_ms(2)

    def run_ms(self, time_ms: float) -> None:
        self.scheduler.run_until(self.scheduler.now_ns + round(time_ms * MS))

    def enable(self, mode: int) -> None:
        self.sdo[0x6060].raw = mode
        for word in (0x06, 0x07, 0x0F):
            self.sdo[0x6040].raw = word
        self.run_ms(5)

    def cycle(self, cycles: int, **objects: int) -> None:
        """Write objects (o607A = ...), then a SYNC in each millisecond."""
        for name, value in objects.items():
            self.sdo[int(name[1:], 16)].raw = value
        for _ in range(cycles):
            self.network.send_message(0x80, b"")
            self.run_ms(1)

    @property
    def word(self) -> int:
        return int(self.sdo[0x6041].raw)

    @property
    def truth_mm(self) -> float:
        return self.plant.axes["z"].position_m() * 1e3

    def home(self, method: int) -> float:
        """Home; return the place of the plant that the drive calls 0 (mm)."""
        self.enable(6)
        self.sdo[0x6098].raw = method
        self.sdo[0x6099][1].raw = round(50 * UNITS_PER_MM)
        self.sdo[0x6099][2].raw = round(SLOW_MM_S * UNITS_PER_MM)
        self.sdo[0x6040].raw = 0x1F
        for _ in range(1000):
            self.run_ms(20)
            if self.sdo[0x6041].raw & REACHED:
                break
        units = self.sdo[0x6064].raw
        return self.truth_mm - units / UNITS_PER_MM


@pytest.fixture
def master() -> Iterator[Callable[..., Master]]:
    with ExitStack() as opened:
        yield lambda *assignments: Master(assignments, opened)


@pytest.mark.parametrize(
    ("method", "home_mm", "seen_mm"),
    [
        (24, 12.0, LATE_MM), (26, 18.0 + 0.02, LATE_MM), (18, 60.0 - 0.02, LATE_MM),
        (17, -50.0 + 0.02, LATE_MM), (8, 12.5, 0.0), (10, 22.5, 0.0), (1, -47.5, 0.0),
        (33, -7.5, 0.0),
    ],
)  # fmt: skip
@pytest.mark.long(but=1)
def test_home_is_where_the_plant_has_it(
    master: Callable[..., Master], method: int, home_mm: float, seen_mm: float
) -> None:
    """Edges of switches (which open 20 um off their cam) to speed times tick, marks exactly."""
    made = master()
    found_mm = made.home(method)
    assert made.sdo[0x6041].raw & (ATTAINED | REACHED | ERROR) == ATTAINED | REACHED
    assert found_mm == pytest.approx(home_mm, abs=max(seen_mm, 1.01 / UNITS_PER_MM))


@pytest.mark.long
@pytest.mark.parametrize(("method", "home_mm"), [(-3, None), (-1, 62.5)])
def test_home_is_the_stop_of_the_plant(
    master: Callable[..., Master], method: int, home_mm: float | None
) -> None:
    """Pressed with 0.5 of the rated torque against 20 N/um; the friction holds some of it back."""
    made = master("plant:positive.low_mm=1000", "plant:home.low_mm=900", "plant:home.high_mm=901")
    found_mm = made.home(method)
    assert made.sdo[0x6041].raw & (ATTAINED | REACHED | ERROR) == ATTAINED | REACHED
    if home_mm is None:
        rated_n = 2.2 * 2 * 3.141592653589793 / 0.01
        pressed_mm = 0.5 * rated_n / 20e6 * 1e3
        friction_mm = 160 / 20e6 * 1e3
        assert 70.0 + 0.9 * pressed_mm - friction_mm < found_mm < 70.0 + pressed_mm
    else:
        assert found_mm == pytest.approx(home_mm, abs=1.01 / UNITS_PER_MM)


@pytest.mark.long
def test_limit_switch_before_the_stop_is_an_error(master: Callable[..., Master]) -> None:
    made = master()
    made.home(-3)
    assert made.sdo[0x6041].raw & (ATTAINED | REACHED | ERROR) == ERROR | REACHED
    assert 60.0 < made.truth_mm < 65.0


@pytest.mark.parametrize(("start_mm", "word"), [(-60, 0b001), (0, 0), (15, 0b100), (65, 0b010)])
def test_inputs_tell_the_switches(master: Callable[..., Master], start_mm: int, word: int) -> None:
    """60FD: bit 0 negative, 1 positive, 2 home."""
    assert master(f"plant:z.position_start_mm={start_mm}").sdo[0x60FD].raw == word


def test_second_encoder_is_the_sensor_that_the_rig_names(master: Callable[..., Master]) -> None:
    """5 mm of offset, counts of 0.1 um."""
    made = master("plant:z.position_start_mm=1.23456")
    assert made.sdo[0x60E4][1].raw == round(6.2346 * UNITS_PER_MM)


@pytest.mark.long
def test_homing_on_a_stop_is_no_following_error(master: Callable[..., Master]) -> None:
    """The demand runs ahead while the axis presses: 6065 of 2.5 mm does not count then."""
    made = master("plant:positive.low_mm=1000", "plant:home.low_mm=900", "plant:home.high_mm=901")
    made.sdo[0x6065].raw = round(2.5 * UNITS_PER_MM)
    made.home(-3)
    assert made.word & (ATTAINED | REACHED | ERROR) == ATTAINED | REACHED


# Limit switches in motion

UP_MM_S = 100.0
BRAKING_MM = UP_MM_S**2 / (2 * 5000)  # 6085 is 5000 mm/s2
DEMANDS = {
    3: ("o60FF", UP_MM_S, -UP_MM_S),
    9: ("o60FF", UP_MM_S, -UP_MM_S),
}


@pytest.mark.parametrize("mode", DEMANDS)
@pytest.mark.long
def test_a_limit_switch_stops_the_axis_and_leaves_the_way_back(
    master: Callable[..., Master], mode: int
) -> None:
    """Quick-stop ramp, bit 11, no motion upwards; downwards, and again upwards off the switch."""
    made = master("plant:z.position_start_mm=40")
    name, up, down = DEMANDS[mode]
    made.enable(mode)
    made.cycle(600, **{name: round(up * UNITS_PER_MM)})
    stood_mm = made.truth_mm
    # The velocity loop lags its ramp: a few times 1/(2 pi 60 Hz) at the speed
    assert 60.0 < stood_mm < 60.0 + BRAKING_MM + UP_MM_S * (250e-6 + 0.02)
    assert made.word & 0x6F == 0x27
    assert made.word & LIMITED
    assert made.emergencies == [0x8612]
    made.cycle(300)
    assert made.truth_mm == pytest.approx(stood_mm, abs=0.01)
    made.cycle(100, **{name: round(down * UNITS_PER_MM)})
    assert made.truth_mm < 59.0
    assert not made.word & LIMITED
    assert not made.sdo[0x60FD].raw & 0b10
    assert made.emergencies == [0x8612, 0x0000]
    made.cycle(2000, **{name: round(0.1 * up * UNITS_PER_MM)})
    assert 60.0 < made.truth_mm < 60.5


@pytest.mark.long
def test_cyclic_position_waits_at_the_limit_switch_for_its_targets(
    master: Callable[..., Master],
) -> None:
    made = master("plant:z.position_start_mm=55")
    made.enable(8)
    for n in range(200):
        made.cycle(1, o607A=round((55 + 0.1 * n) * UNITS_PER_MM))
    stood_mm = made.truth_mm
    assert 60.0 < stood_mm < 60.0 + BRAKING_MM + 3.0
    assert made.word & LIMITED
    for n in range(60):
        made.cycle(1, o607A=round((75 - 0.1 * n) * UNITS_PER_MM))
    assert made.truth_mm == pytest.approx(stood_mm, abs=0.01)
    for n in range(60, 300):
        made.cycle(1, o607A=round((75 - 0.1 * n) * UNITS_PER_MM))
    made.cycle(500)
    assert made.truth_mm == pytest.approx(75 - 29.9, abs=0.02)
    assert not made.word & LIMITED


@pytest.mark.long
def test_set_points_beyond_the_limit_switch_end_where_the_axis_stopped(
    master: Callable[..., Master],
) -> None:
    made = master("plant:z.position_start_mm=50")
    made.enable(1)
    made.cycle(1, o607A=round(100 * UNITS_PER_MM), o6040=0x3F)
    made.cycle(800, o6040=0x0F)
    stood_mm = made.truth_mm
    assert 60.0 < stood_mm < 60.0 + BRAKING_MM + 3.0
    made.cycle(500, o607A=round(110 * UNITS_PER_MM), o6040=0x3F)
    assert made.truth_mm == pytest.approx(stood_mm, abs=0.02)
    made.cycle(1, o607A=round(30 * UNITS_PER_MM), o6040=0x0F)
    made.cycle(1500, o6040=0x3F)
    assert made.truth_mm == pytest.approx(30.0, abs=0.02)


@pytest.mark.long
@pytest.mark.parametrize(("start_mm", "free"), [(62.0, -1), (-52.0, 1)])
def test_an_axis_that_is_enabled_on_a_limit_switch_moves_off_it_only(
    master: Callable[..., Master], start_mm: float, free: int
) -> None:
    made = master(f"plant:z.position_start_mm={start_mm}")
    made.enable(9)
    made.cycle(300, o60FF=round(-free * 20 * UNITS_PER_MM))
    assert made.truth_mm == pytest.approx(start_mm, abs=0.01)
    made.cycle(300, o60FF=round(free * 20 * UNITS_PER_MM))
    assert (made.truth_mm - start_mm) * free > 5.0


@pytest.mark.long
def test_torque_acts_away_from_the_limit_switch_only(master: Callable[..., Master]) -> None:
    made = master("plant:z.position_start_mm=62")
    made.enable(10)
    made.cycle(300, o6071=300)
    assert made.truth_mm == pytest.approx(62.0, abs=0.01)
    made.cycle(100, o6071=-300)
    assert made.truth_mm < 61.0


@pytest.mark.long
def test_homing_on_a_limit_switch_is_no_emergency(master: Callable[..., Master]) -> None:
    made = master()
    made.home(18)
    assert made.word & (ATTAINED | REACHED | ERROR) == ATTAINED | REACHED
    assert made.emergencies == []


@pytest.mark.long
def test_a_program_that_runs_into_a_limit_switch_ends_with_an_alarm(
    run_own: Callable[..., Any], tmp_path: Path
) -> None:
    """Never as if it had reached its target."""
    program = tmp_path / "far.nc"
    program.write_text("%far\nN10 G90 G1 Z65 F600\nN20 Z0\nN30 M30\n")
    out = run_own(program, RIG)
    assert out.alarms == [900025]
    assert 60.0 < out.column("Z.truth_mm")[-1] < 61.0


def test_a_switch_is_not_expected_to_tell_contacts(master: Callable[..., Master]) -> None:
    assert master().plant.notes["home"] == []
