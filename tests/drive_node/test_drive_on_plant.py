"""Stops, modes and limits of the drive on a plant, by closed forms of one mass without friction.

The plant is the library's ServoAxis; its truth output is compared, never what the drive says.
Mass with motor: m = 120 kg + 1.8e-4 kg m2 (2 pi / 10 mm)2. At rated torque
2.2 N.m the force is 2 pi 2.2 / 0.01 N.
"""

import math
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from axisrig.fmus.build import ensure_built
from axisrig.kernel.cosim.fmi.fmu import load_fmu
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import MS, US

Make = Callable[..., Any]
PER_M = 104_857_600
MASS_KG = 120.0 + 1.8e-4 * (2 * math.pi / 0.01) ** 2
RATED_N = 2 * math.pi * 2.2 / 0.01
SMOOTH = {"coulomb_friction": 0.0, "breakaway_friction": 0.0, "viscous_friction": 0.0}
SYNC_NS = 48_000
TICK_NS = 250_000
STEP = 10_486  # position units per ms
V_M_S = STEP * 1000 / PER_M


@pytest.fixture
def plant_axis() -> Iterator[Callable[..., PlantAxis]]:
    """Make a ServoAxis with these parameters."""
    plants: list[Plant] = []

    def make(**parameters: float) -> PlantAxis:
        plant = Plant()
        plants.append(plant)
        slave = load_fmu(ensure_built("AxisRig.Drives.ServoAxis"), "x")
        for name, value in {**SMOOTH, **parameters}.items():
            slave.set_start(name, value)
        axis = plant.add_axis(slave)
        plant.initialize(0)
        return axis

    yield make
    for plant in plants:
        plant.close()


class Running:
    """A drive bench with a SYNC in each millisecond."""

    def __init__(self, bench: Any) -> None:
        self.bench, self.axis, self.sdo = bench, bench.axis, bench.remote.sdo
        self.target = 0

    def run_ms(self, cycles: int, word: int | None = None, step: int = 0) -> None:
        for _ in range(cycles):
            self.target += step
            if word is not None:
                self.bench.set_values(word, self.target)
            now_ns = self.bench.scheduler.now_ns
            self.bench.run_to_ms(now_ns // MS + 1)
            self.bench.master.send_message(0x80, b"")
            self.bench.scheduler.run_until(self.bench.scheduler.now_ns + 600 * US)

    def set(self, **objects: int) -> "Running":
        for name, value in objects.items():
            index, _, sub = name.removeprefix("o").partition("_")
            entry = self.sdo[int(index, 16)]
            (entry[int(sub)] if sub else entry).raw = value
        return self

    def enable(self, mode: int = 8) -> "Running":
        self.sdo[0x6060].raw = mode
        self.bench.remote.nmt.send_command(1)
        for word in (0x06, 0x07, 0x0F):
            self.run_ms(1, word)
        return self

    def cruise(self) -> "Running":
        """100 mm/s in csp until the lag is steady (20 time constants 1/Kv)."""
        self.run_ms(2000, 0x0F, STEP)
        return self

    def at(self, time_ns: int) -> tuple[float, float]:
        """True position and velocity at an instant to come."""
        self.bench.scheduler.run_until(time_ns)
        self.axis.advance_to(time_ns)
        return self.axis.motion[0], self.axis.motion[1]

    def state(self) -> State:
        found: State = self.bench.node.state
        return found


@pytest.fixture
def running(drive_bench: Make, plant_axis: Callable[..., PlantAxis]) -> Callable[..., Running]:
    return lambda **parameters: Running(drive_bench(plant_axis(**parameters)))


RAMPS = [
    ("605A", 2, 0x02, "6085", State.SWITCH_ON_DISABLED),
    ("605A", 1, 0x02, "6084", State.SWITCH_ON_DISABLED),
    ("605A", 6, 0x02, "6085", State.QUICK_STOP_ACTIVE),
    ("605A", 5, 0x02, "6084", State.QUICK_STOP_ACTIVE),
    ("605B", 1, 0x06, "6084", State.READY_TO_SWITCH_ON),
    ("605C", 1, 0x07, "6084", State.SWITCHED_ON),
    ("605D", 1, 0x10F, "6084", State.OPERATION_ENABLED),
    ("605D", 2, 0x10F, "6085", State.OPERATION_ENABLED),
]


@pytest.mark.parametrize(("option", "code", "word", "ramp", "end"), RAMPS)
@pytest.mark.long(but=1)
def test_a_ramp_stops_after_v2_by_2a(
    running: Callable[..., Running], option: str, code: int, word: int, ramp: str, end: State
) -> None:
    """From 0.1 m/s with 0.5 m/s2: 10 mm in 200 ms; the other ramp object says 3 m/s2.

    The integral of the velocity error over the whole ramp is 0 (PI loop, nothing to overcome), so
    the way is exact; the axis is held there, or let go once it has been at less than 1 um/s for
    20 ms.
    """
    rates = {
        "o606F": 100,
        "o6070": 20,
        "o6084": round(3 * PER_M),
        "o6085": round(3 * PER_M),
        f"o{ramp}": round(PER_M / 2),
    }
    drive = running().set(**rates, **{f"o{option}": code}).enable().cruise()
    begin_m = drive.axis.motion[0]
    begin_ns = drive.axis.slave.time_ns
    drive.run_ms(1, word)
    stop_ns = drive.axis.slave.time_ns // MS * MS + SYNC_NS  # the SYNC that brings the word
    begin_m += V_M_S * (stop_ns - begin_ns) * 1e-9
    drive.run_ms(100, word)
    elapsed_s = (drive.axis.slave.time_ns - stop_ns) * 1e-9
    assert drive.axis.motion[1] == pytest.approx(V_M_S - 0.5 * elapsed_s, abs=1e-5)
    assert drive.state() in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)
    drive.run_ms(98, word)  # until 1.6 ms before the end of the ramp
    assert drive.state() in (State.OPERATION_ENABLED, State.QUICK_STOP_ACTIVE)
    drive.run_ms(200, word)
    assert drive.state() is end
    assert drive.axis.motion[0] == pytest.approx(begin_m + V_M_S**2 / (2 * 0.5), abs=2e-6)
    assert abs(drive.axis.motion[1]) < 1e-3


@pytest.mark.parametrize("code", [3, 4, 7, 8])
@pytest.mark.long(but=1)
def test_the_current_limit_stops_after_m_v2_by_2f(
    running: Callable[..., Running], code: int
) -> None:
    """6072 = 300 per mille: F = 414.7 N, a = F/m = 2.17 m/s2; the current loop lags 0.2 ms.

    At standstill the integral part (Tn = 8 ms, K = 2 pi 60 Hz m) still holds F; emptying it takes
    the axis back by F Tn / K. An axis that is not held is let go before.
    """
    drive = running().set(o605A=code, o6072=300).enable().cruise()
    begin_m, begin_ns = drive.axis.motion[0], drive.axis.slave.time_ns
    drive.run_ms(1, 0x02)
    stop_ns = drive.axis.slave.time_ns // MS * MS + SYNC_NS
    begin_m += V_M_S * (stop_ns - begin_ns) * 1e-9
    force_n = 0.3 * RATED_N
    drive.run_ms(20, 0x02)
    elapsed_s = (drive.axis.slave.time_ns - stop_ns) * 1e-9
    lag_s = 1 / (2 * math.pi * 800)
    expected = V_M_S - force_n / MASS_KG * (elapsed_s - lag_s)
    assert drive.axis.motion[1] == pytest.approx(expected, abs=1e-5)
    drive.run_ms(300, 0x02)
    way_m = V_M_S * lag_s + MASS_KG * V_M_S**2 / (2 * force_n)
    way_m -= force_n * 8e-3 / (2 * math.pi * 60 * MASS_KG)
    is_held = drive.state() is State.QUICK_STOP_ACTIVE
    assert is_held == (code > 4)
    if is_held:
        assert drive.axis.motion[0] == pytest.approx(begin_m + way_m, abs=1e-6)


@pytest.mark.parametrize(
    ("option", "word", "end"),
    [
        ("605A", 0x02, State.SWITCH_ON_DISABLED),
        ("605B", 0x06, State.READY_TO_SWITCH_ON),
        ("605C", 0x07, State.SWITCHED_ON),
        (None, 0x00, State.SWITCH_ON_DISABLED),
    ],
)
@pytest.mark.long(but=1)
def test_code_0_and_disable_voltage_let_the_axis_coast(
    running: Callable[..., Running], option: str | None, word: int, end: State
) -> None:
    """Without friction the axis runs on with the same velocity."""
    drive = running().set(**({f"o{option}": 0} if option else {})).enable().cruise()
    drive.run_ms(2, word)
    assert drive.state() is end
    begin_m, begin_ns = drive.axis.motion[0], drive.axis.slave.time_ns
    drive.run_ms(100, word)
    passed_s = (drive.axis.slave.time_ns - begin_ns) * 1e-9
    assert drive.axis.motion[0] - begin_m == pytest.approx(V_M_S * passed_s, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(("code", "ramp_m_s2"), [(0, 0.0), (1, 0.4), (2, 0.8)])
def test_fault_reaction_brakes_and_ends_in_fault(
    running: Callable[..., Running], code: int, ramp_m_s2: float
) -> None:
    drive = running().set(o605E=code, o6084=round(0.4 * PER_M), o6085=round(0.8 * PER_M))
    drive.enable().cruise()
    now_ns = drive.bench.scheduler.now_ns
    drive.bench.node.servo.fault(0x2310, 0x02, now_ns)
    begin_m, _ = drive.at(now_ns)
    assert drive.state() is State.FAULT_REACTION_ACTIVE
    if not ramp_m_s2:
        drive.run_ms(1)
        assert drive.state() is State.FAULT
        return
    ramp_s = V_M_S / ramp_m_s2
    drive.at(now_ns + round((ramp_s - 1e-3) * 1e9))
    assert drive.state() is State.FAULT_REACTION_ACTIVE
    end_m, _ = drive.at(now_ns + round((ramp_s + 0.1) * 1e9))
    assert drive.state() is State.FAULT
    # Let go as soon as it is slower than 606F (0.5 mm/s): less than that times 0.1 s
    assert end_m == pytest.approx(begin_m + V_M_S**2 / (2 * ramp_m_s2), abs=5e-5)
    assert drive.sdo[0x603F].raw == 0x2310


@pytest.mark.parametrize(
    ("option", "end", "way_m"),
    [
        (0, State.OPERATION_ENABLED, None),
        (1, State.FAULT, 0.01),
        (2, State.SWITCH_ON_DISABLED, None),
        (3, State.SWITCH_ON_DISABLED, 0.01),
    ],
)
@pytest.mark.long(but=1)
def test_a_lost_connection_acts_by_6007(
    running: Callable[..., Running], option: int, end: State, way_m: float | None
) -> None:
    drive = running().set(o6007=option, o6085=round(PER_M / 2)).enable().cruise()
    now_ns = drive.bench.scheduler.now_ns
    drive.bench.node.servo.connection_lost(now_ns)
    begin_m, _ = drive.at(now_ns)
    end_m, _ = drive.at(now_ns + 300 * MS)
    assert drive.state() is end
    if way_m is not None:
        assert end_m - begin_m == pytest.approx(way_m, abs=5e-5)


def test_csv_reaches_its_target_over_one_period(running: Callable[..., Running]) -> None:
    """60FF + 60B1; the steady velocity has no error, the ramp of 1 ms is followed by the loop."""
    drive = running().set(o60FF=PER_M // 20, o60B1=PER_M // 50).enable(9)
    drive.run_ms(300)
    assert drive.axis.motion[1] == pytest.approx(0.05 + 0.02, rel=1e-6)
    assert drive.sdo[0x606C].raw == pytest.approx(PER_M * 0.07, rel=1e-5)
    assert drive.sdo[0x60F4].raw == 0


@pytest.mark.parametrize(("target", "offset", "acting"), [(100, 0, 100), (100, -160, -60)])
def test_cst_accelerates_with_f_by_m(
    running: Callable[..., Running], target: int, offset: int, acting: int
) -> None:
    """The force comes one SYNC after the axis is enabled, behind the current loop of 800 Hz."""
    drive = running().set(o6071=target, o60B2=offset).enable(10)
    begin_ns = drive.bench.scheduler.now_ns - 600 * US + SYNC_NS + 1 * MS
    drive.run_ms(100)
    elapsed_s = (drive.bench.scheduler.now_ns - begin_ns) * 1e-9
    lag_s = 1 / (2 * math.pi * 800)
    expected = acting / 1000 * RATED_N / MASS_KG * (elapsed_s - lag_s)
    drive.axis.advance_to(drive.bench.scheduler.now_ns)
    assert drive.axis.motion[1] == pytest.approx(expected, rel=1e-5)
    assert drive.sdo[0x6077].raw == acting
    assert drive.sdo[0x6078].raw == acting


@pytest.mark.parametrize(
    ("limits", "target", "acting"),
    [
        ({"o6072": 80}, 100, 80),
        ({"o60E0": 70}, 100, 70),
        ({"o60E1": 70}, 100, 100),
        ({"o60E1": 70}, -100, -70),
        ({"o6072": 60, "o60E0": 70}, 100, 60),
        ({"o6072": 65535}, 32767, 4000 / RATED_N * 1000),
    ],
)
def test_torque_limits_the_least_counts(
    running: Callable[..., Running], limits: dict[str, int], target: int, acting: float
) -> None:
    """In the last row the motor's own 4000 N; bit 11 shows a limit of the objects."""
    drive = running().set(o6071=target, **limits).enable(10)
    drive.run_ms(10)
    assert drive.axis.force_n() == pytest.approx(acting / 1000 * RATED_N, rel=1e-6)
    assert bool(drive.sdo[0x6041].raw & 1 << 11) == (acting != target and target < 1000)


@pytest.mark.long
def test_a_torque_limit_given_by_sdo_acts_at_the_next_sync_in_csp(
    running: Callable[..., Running],
) -> None:
    """Pushed against a stop at 0.5 mm with 1 mm/s: the force stays at 10 % of the rated one."""
    drive = running(stop_position=0.0005).enable()
    drive.run_ms(300, 0x0F, round(PER_M * 0.001 * 1e-3))
    drive.set(o6072=100)
    drive.run_ms(2000, 0x0F, round(PER_M * 0.001 * 1e-3))
    assert drive.axis.force_n() == pytest.approx(0.1 * RATED_N, rel=1e-6)
    assert drive.sdo[0x6041].raw & 1 << 11
    assert drive.axis.motion[0] == pytest.approx(0.0005 + 0.1 * RATED_N / 20e6, abs=1e-8)


def test_following_error_fault_comes_6066_after_the_first_tick_beyond_6065(
    running: Callable[..., Running],
) -> None:
    """A twin without monitoring tells at which tick the lag passes 4 mm on its way to v/Kv = 10 mm.

    The drive must fault 20 ms after that tick, at a tick.
    """
    twin = running().enable()
    start_ns = twin.bench.scheduler.now_ns - 600 * US + SYNC_NS
    beyond_ns = None
    step = STEP
    while beyond_ns is None:
        twin.target += step
        twin.bench.set_values(0x0F, twin.target)
        twin.bench.run_to_ms(twin.bench.scheduler.now_ns // MS + 1)
        sync_ns = twin.bench.scheduler.now_ns
        twin.bench.master.send_message(0x80, b"")
        for tick in range(4):
            now_ns = sync_ns + SYNC_NS + tick * TICK_NS
            twin.at(now_ns)
            lag = twin.axis.motion[4] - twin.axis.motion[2]
            if beyond_ns is None and round(lag * PER_M) > 419_430:
                beyond_ns = now_ns
        assert now_ns < start_ns + 200 * MS
    drive = running().set(o6065=419_430, o6066=20).enable()
    assert drive.bench.scheduler.now_ns - 600 * US + SYNC_NS == start_ns
    cycles = (beyond_ns - start_ns) // MS + 19
    drive.run_ms(cycles, 0x0F, step)
    drive.target += step
    drive.bench.set_values(0x0F, drive.target)
    drive.bench.run_to_ms(drive.bench.scheduler.now_ns // MS + 1)
    drive.bench.master.send_message(0x80, b"")
    drive.bench.scheduler.run_until(beyond_ns + 20 * MS - 1)
    assert drive.state() is State.OPERATION_ENABLED
    drive.bench.scheduler.run_until(beyond_ns + 20 * MS)
    assert drive.state() is State.FAULT_REACTION_ACTIVE
    drive.run_ms(1)
    assert drive.bench.frames(0x083)[0][:3] == bytes.fromhex("118621")


@pytest.mark.long
def test_ticks_change_no_byte_on_the_bus(running: Callable[..., Running]) -> None:
    """6065 = FFFFFFFF needs no ticks; one less is monitored and never exceeded."""
    frames = []
    for window in (0xFFFFFFFF, 0xFFFFFFFE):
        drive = running(coulomb_friction=120.0, breakaway_friction=160.0).set(o6065=window).enable()
        drive.run_ms(100, 0x0F, 7919)
        drive.run_ms(100, 0x0F, -3001)
        frames.append([drive.bench.frames(cob_id) for cob_id in (0x183, 0x283, 0x383)])
    assert frames[0] == frames[1]


@pytest.mark.long
@pytest.mark.parametrize(("mode", "objects"), [(9, {"o60FF": STEP * 1000}), (10, {"o6071": 0})])
def test_a_change_of_control_in_motion_is_no_jump(
    running: Callable[..., Running], mode: int, objects: dict[str, int]
) -> None:
    """Csp at 100 mm/s, then csv with the same speed or cst without torque: it runs on so.

    Nothing brakes this axis, so its velocity must not change by more than the rest of the lag
    that still runs in, 1e-6 of it.
    """
    drive = running().set(**objects).enable().cruise()
    begin_m, before_m_s = drive.axis.motion[0], drive.axis.motion[1]
    begin_ns = drive.axis.slave.time_ns
    drive.sdo[0x6060].raw = mode
    for _ in range(100):
        drive.run_ms(1, 0x0F)
        assert drive.axis.motion[1] == pytest.approx(before_m_s, rel=2e-5)
    assert drive.sdo[0x6061].raw == mode
    passed_s = (drive.axis.slave.time_ns - begin_ns) * 1e-9
    assert drive.axis.motion[0] - begin_m == pytest.approx(V_M_S * passed_s, rel=2e-5)


@pytest.mark.long
def test_csv_is_stopped_before_csp_takes_over_and_the_axis_stays_there(
    running: Callable[..., Running],
) -> None:
    """6084 = 0.5 m/s2 from 0.1 m/s: 10 mm, then held; the target of before does not count."""
    drive = running().set(o6084=PER_M // 2, o606F=100, o6070=10, o60FF=STEP * 1000).enable(9)
    drive.run_ms(500, 0x0F)
    drive.sdo[0x6060].raw = 8
    begin_ns = drive.bench.scheduler.now_ns
    begin_m, _ = drive.at(begin_ns)
    drive.run_ms(500, None)
    assert drive.sdo[0x6061].raw == 8
    # SDO answered some 0.2 ms after the write acted
    assert drive.axis.motion[0] == pytest.approx(begin_m + V_M_S**2, abs=V_M_S * 0.5e-3)
    here_m = drive.axis.motion[0]
    drive.run_ms(200, None)
    assert drive.axis.motion[0] == pytest.approx(here_m, abs=1e-8)
