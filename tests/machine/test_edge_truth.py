"""Where axes were at the edges of the signals that they watch, against closed forms."""

from collections.abc import Callable, Collection, Mapping
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.conftest import RunNc

from axisrig.bench.machine.recording.edge_log import EdgeLog, Watcher
from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.oracles.sources.chain import Stamps
from axisrig.bench.record.edges import EdgeTruth, edges_of
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.time.clock import MS, US

# --- the instant that counts


@pytest.mark.parametrize(
    ("times", "edge_ns", "instant_ns"),
    [
        (LatchTimes(), 1_234_567, 1_234_567),
        (LatchTimes(delay_ns=4_000), 1_234_567, 1_238_567),
        (LatchTimes(delay_ns=4_000, compensation_ns=50_000), 1_234_567, 1_188_567),
        (LatchTimes(delay_ns=4_000, compensation_ns=50_000), 1_000, 0),
        (LatchTimes(delay_ns=4_000, sample_ns=62_500), 121_000, 125_000),
        (LatchTimes(delay_ns=4_000, sample_ns=62_500), 120_999, 62_500),
        (LatchTimes(delay_ns=4_000, jitter_ns=900), 10, 4_010),
        # The stamp is 1 us + 3 us filter + 7 us offset, in steps of 2 us; the offset is believed
        (LatchTimes(3_000, stamps=Stamps(2_000, 7_000, 0.0, 7_000)), 1_000, 3_000),
        (LatchTimes(3_000, stamps=Stamps(1, 7_000, 0.0, 5_000)), 1_000, 6_000),
    ],
)
def test_the_instant_of_a_latch_follows_from_its_edge(
    times: LatchTimes, edge_ns: int, instant_ns: int
) -> None:
    assert times.instant_ns(edge_ns) == instant_ns


# --- positions between the ends of the steps of a plant

STEP_NS = MS
Course = Callable[[float], tuple[float, float]]
"""Position and velocity at a time, m and m/s."""


def even(start_m: float, speed_m_s: float) -> Course:
    return lambda t: (start_m + speed_m_s * t, speed_m_s)


def accelerated(start_m: float, speed_m_s: float, acceleration_m_s2: float) -> Course:
    return lambda t: (
        start_m + speed_m_s * t + acceleration_m_s2 * t * t / 2.0,
        speed_m_s + acceleration_m_s2 * t,
    )


class Axis:
    """A plant that keeps its motion at whole ms from an instant on."""

    def __init__(
        self, load: Course, motor: Course | None = None, off_m: float | None = None, kept: int = 0
    ) -> None:
        self._load, self._motor, self._off_m, self._kept = load, motor or load, off_m, kept

    def _at(self, ns: int) -> tuple[int, list[float]]:
        return ns, [*self._load(ns * 1e-9), *self._motor(ns * 1e-9), 0.0, 0.0, 0.0, 0.0]

    def ends_around(self, ns: int) -> Any:
        if ns < self._kept:
            raise PlantError("z", ns, "no motion is recorded for this instant")
        begin = ns - ns % STEP_NS
        return (self._at(begin), self._at(begin if begin == ns else begin + STEP_NS))

    def position_m(self) -> float:
        return 0.5

    def second_encoder_m(self) -> float | None:
        return None if self._off_m is None else 0.5 + self._off_m


class Bench:
    """A log over axes and the signals of two probes; `at` lets edges come and time pass."""

    def __init__(
        self,
        axes: Mapping[str, Axis],
        watchers: Mapping[str, list[Watcher]],
        slaves: Mapping[str, str] | None = None,
    ) -> None:
        def slaves_of(masters: Collection[str]) -> Mapping[str, str]:
            return {slave: by for slave, by in (slaves or {}).items() if by in masters}

        self.signals = {name: SimpleNamespace(edges=[]) for name in watchers}
        probes = {name: SimpleNamespace(signal=each) for name, each in self.signals.items()}
        self.plant = SimpleNamespace(probes=probes, now_ns=0)
        self.log = EdgeLog(self.plant, axes, watchers, slaves_of)  # type: ignore[arg-type]

    def at(self, now_ns: int, **edges: tuple[int, bool]) -> None:
        for name, edge in edges.items():
            self.signals[name].edges.append(edge)
        self.plant.now_ns = now_ns
        self.log.look()


def watcher(axis: str, delay_us: int = 0) -> Watcher:
    return Watcher(axis, LatchTimes(delay_ns=delay_us * US))


@pytest.mark.interpreted
def test_each_axis_has_its_own_place_speed_and_direction() -> None:
    """X goes up evenly, Y down and faster and faster; their drives have other delays."""
    axes = {"X": Axis(even(0.1, 0.02)), "Y": Axis(accelerated(0.3, -0.01, -2.0))}
    bench = Bench(axes, {"probe": [watcher("X", 500), watcher("Y", 300)]})
    bench.at(3 * MS, probe=(2_400_000, True))
    x, y = bench.log.rows()
    assert (x.axis, y.axis, x.edge_ns, x.level) == ("X", "Y", 2_400_000, True)
    assert x.load_mm == pytest.approx(100.0 + 20.0 * 2.4e-3, abs=1e-9)
    assert y.load_mm == pytest.approx(300.0 - 10.0 * 2.4e-3 - 1000.0 * 2.4e-3**2, abs=1e-9)
    assert x.latch_ns == 2_900_000
    assert x.latch_motor_mm == pytest.approx(100.0 + 20.0 * 2.9e-3, abs=1e-9)
    assert y.latch_ns == 2_700_000
    assert y.latch_load_mm == pytest.approx(300.0 - 10.0 * 2.7e-3 - 1000.0 * 2.7e-3**2, abs=1e-9)


@pytest.mark.interpreted
def test_motor_load_and_second_encoder_are_distinguished() -> None:
    """An elastic axis: the motor is ahead, the scale is 30 um off."""
    axis = Axis(even(0.0, 0.01), accelerated(0.001, 0.01, 4.0), off_m=30e-6)
    bench = Bench({"Z": axis}, {"probe": [watcher("Z", 200)]})
    bench.at(2 * MS, probe=(1_100_000, False))
    (row,) = bench.log.rows()
    assert row.motor_mm == pytest.approx(1.0 + 10.0 * 1.1e-3 + 2000.0 * 1.1e-3**2, abs=1e-9)
    assert row.load_mm == pytest.approx(10.0 * 1.1e-3, abs=1e-9)
    assert row.second_mm == pytest.approx(10.0 * 1.1e-3 + 0.03, abs=1e-9)
    assert row.latch_motor_mm == pytest.approx(1.0 + 10.0 * 1.3e-3 + 2000.0 * 1.3e-3**2, abs=1e-9)
    assert row.latch_second_mm == pytest.approx(10.0 * 1.3e-3 + 0.03, abs=1e-9)


@pytest.mark.interpreted
def test_a_latch_whose_instant_the_run_does_not_reach_has_no_place() -> None:
    late = Watcher("Z", LatchTimes(delay_ns=500 * US, jitter_ns=900))
    bench = Bench({"Z": Axis(even(0.0, 0.01))}, {"probe": [late]})
    bench.at(1 * MS, probe=(800_000, True))
    (before,) = bench.log.rows()
    assert before.load_mm == pytest.approx(0.008, abs=1e-9)
    assert (before.latch_ns, before.latch_motor_mm) == (1_300_000, None)
    assert before.latch_jitter_ns == 900
    bench.at(1_299_999)
    assert bench.log.rows() == (before,)
    bench.at(1_300_000)
    (after,) = bench.log.rows()
    assert after.latch_motor_mm == pytest.approx(0.013, abs=1e-9)


@pytest.mark.interpreted
def test_a_motion_that_is_not_kept_any_more_has_no_place() -> None:
    bench = Bench({"Z": Axis(even(0.0, 0.01), kept=2 * MS)}, {"probe": [watcher("Z", 900)]})
    bench.at(9 * MS, probe=(1_500_000, True))
    (row,) = bench.log.rows()
    assert (row.motor_mm, row.load_mm) == (None, None)
    assert row.latch_motor_mm == pytest.approx(0.024, abs=1e-9)


@pytest.mark.interpreted
def test_a_slave_is_beside_its_master_at_the_instants_of_the_master() -> None:
    axes = {name: Axis(even(at, 0.01)) for name, at in (("X", 0.1), ("X2", 0.2), ("Y", 0.3))}
    bench = Bench(axes, {"probe": [watcher("X", 400)]}, {"X2": "X", "Y": "Z"})
    bench.at(2 * MS, probe=(1 * MS, True))
    rows = bench.log.rows()
    assert [row.axis for row in rows] == ["X", "X2"]
    assert {row.latch_ns for row in rows} == {1_400_000}
    assert [row.latch_load_mm for row in rows] == pytest.approx([100.014, 200.014], abs=1e-9)


@pytest.mark.interpreted
def test_a_slave_is_there_for_each_who_reads_the_signal_of_its_master() -> None:
    """The drive of X reads the probe after 0.4 ms, the terminal, for any axis, after 0.1 ms."""
    axes = {name: Axis(even(at, 0.01)) for name, at in (("X", 0.1), ("X2", 0.2))}
    terminal = LatchTimes(delay_ns=100 * US)
    at_plc = [Watcher(name, terminal, "terminal") for name in axes]
    bench = Bench(axes, {"probe": [watcher("X", 400), *at_plc]}, {"X2": "X"})
    bench.at(2 * MS, probe=(1 * MS, True))
    seen = [(row.axis, row.read_by, row.latch_ns) for row in bench.log.rows()]
    assert seen == [
        ("X", "drive", 1_400_000),
        ("X", "terminal", 1_100_000),
        ("X2", "drive", 1_400_000),
        ("X2", "terminal", 1_100_000),
    ]
    alone = Bench(axes, {"probe": at_plc[:1]}, {"X2": "X"})
    alone.at(2 * MS, probe=(1 * MS, True))
    assert {row.read_by for row in alone.log.rows()} == {"terminal"}


@pytest.mark.interpreted
def test_edges_of_two_signals_are_in_the_order_of_their_instants() -> None:
    axes = {"X": Axis(even(0.0, 0.01)), "Z": Axis(even(0.0, -0.01))}
    bench = Bench(axes, {"one": [watcher("Z")], "two": [watcher("X"), watcher("Z")]})
    bench.at(5 * MS, one=(4 * MS, True), two=(3 * MS, True))
    bench.at(9 * MS, one=(8 * MS, False))
    rows = bench.log.rows()
    seen = [(row.probe, row.axis, row.edge_ns // MS) for row in rows]
    assert seen == [("two", "X", 3), ("two", "Z", 3), ("one", "Z", 4), ("one", "Z", 8)]
    found = edges_of(rows, axis="Z", begin_ns=4 * MS, end_ns=8 * MS)
    assert [row.edge_ns // MS for row in found] == [4, 8]
    assert edges_of(rows, axis="Z", begin_ns=4 * MS, end_ns=8 * MS, level=False) == [rows[3]]
    assert edges_of(rows, axis="Z", begin_ns=0, end_ns=8 * MS, probe="two") == [rows[1]]
    assert edges_of(rows, axis="X", begin_ns=0, end_ns=9 * MS, read_by="terminal") == []
    assert edges_of(None, axis="X", begin_ns=0, end_ns=9 * MS) == []


# --- machines

FREE = [
    f"plant:{a}.{key}=0" for a in "xz" for key in ("coulomb_friction_n", "breakaway_friction_n")
]


def way_mm(begin_mm: float | None, end_mm: float | None) -> float:
    """From one place to another, both known."""
    assert begin_mm is not None
    assert end_mm is not None
    return end_mm - begin_mm


def rows_of(out: Any, level: bool = True) -> dict[str, EdgeTruth]:
    """The first edge of each axis."""
    assert out.alarms == []
    rows = [row for row in out.facts.edges if row.level is level]
    return {row.axis: row for row in reversed(rows)}


@pytest.mark.long
def test_an_even_motion_in_inch_down_and_sideways(run_nc: RunNc) -> None:
    """Speeds are those of the path, the edge is at the surface, the latch one delay later.

    4 s/40 after the begin what the loop of an axis answers has died away to exp(-20).
    """
    x_mm, z_mm = 0.15 * 25.4, 3.85 * 25.4
    way_mm = (x_mm**2 + (104.0 - z_mm) ** 2) ** 0.5
    out = run_nc(
        "N5 G70\nN10 G100 X.15 Z3.85 F23.62204724409449",
        "",
        *FREE,
        "plant:z.position_start_mm=104",
        "drive:all.input_delay_us=300",
    )
    rows = rows_of(out)
    assert list(rows) == ["Z", "Y", "X"]
    speeds_mm_s = {"X": 10.0 * x_mm / way_mm, "Z": -10.0 * (104.0 - z_mm) / way_mm}
    share = 4.0 / (104.0 - z_mm)
    for axis, at_mm in (("X", x_mm * share), ("Z", 100.0)):
        row = rows[axis]
        assert row.latch_ns == row.edge_ns + 300 * US
        assert row.load_mm == pytest.approx(at_mm, abs=1e-6)
        assert row.latch_load_mm == pytest.approx(at_mm + speeds_mm_s[axis] * 3e-4, abs=1e-6)
    assert rows["Z"].load_mm == pytest.approx(100.0, abs=1e-8)
    # What the run measured is the truth to its last increment of 9.5 nm
    latched_mm = out.facts.runs[0].latched_mm
    assert set(latched_mm) >= {"X", "Z"}
    for axis, value_mm in latched_mm.items():
        assert value_mm == pytest.approx(rows[axis].latch_motor_mm, abs=10e-6)


@pytest.mark.long
@pytest.mark.parametrize("sign", [-1, 1])
def test_backlash_and_twist_are_between_motor_and_load(run_nc: RunNc, sign: int) -> None:
    """120 N and 800 N s/m at 10 mm/s through 120 N/um, and half of 10 um; a scale at the load."""
    rig = f"""
    [plant.z]
    fmu = "AxisRig.Drives.ScrewAxis"
    [plant.z.start]
    position_start_mm = {100 - 4 * sign}.0
    backlash_um = 10
    "friction.breakaway_n" = 120
    [axis.Z]
    encoder_2 = "load"
    [plant.probe]
    start = {{ normal_x = 0, normal_y = 0, normal_z = {-sign}, surface_mm = {-sign * 100.0} }}
    """
    out = run_nc(f"N10 G100 Z{100 + 4 * sign} F600", rig, "drive:servo.input_delay_us=400")
    row = rows_of(out)["Z"]
    ahead_mm = sign * (0.010 / 2 + 128 / 120e3)
    assert row.load_mm == pytest.approx(100.0, abs=1e-8)
    assert row.motor_mm == pytest.approx(100.0 + ahead_mm, abs=0.05e-3)
    assert row.second_mm == row.load_mm
    assert row.latch_load_mm == pytest.approx(100.0 + sign * 10.0 * 4e-4, abs=1e-5)
    assert row.latch_second_mm == row.latch_load_mm


SWITCH = """
    [axis.{axis}]
    probe_1 = "cam"
    [plant.cam]
    fmu = "AxisRig.Sensors.PositionSwitch"
    start = {{ low_mm = {low}, hysteresis_um = 20 }}
    wire = {{ x = "{plant}" }}
"""


@pytest.mark.long
def test_the_slave_of_a_portal_is_where_it_is(run_nc: RunNc) -> None:
    """X2 keeps its 30 mm; without the coupling it has no row."""
    rig = SWITCH.format(axis="X", low=2, plant="x")
    measure = "N40 G100 X4 F600"
    coupled = "N20 #SET AX LINK[1, [X2=X,G,15,20]]\nN30 #ENABLE AX LINK[1]\n"
    rows = rows_of(run_nc(coupled + measure, rig, base="gantry-x.toml"))
    assert set(rows) == {"X", "X2"}
    assert rows["X"].load_mm == pytest.approx(2.0, abs=1e-8)
    assert rows["X2"].load_mm == pytest.approx(32.0, abs=1e-6)
    assert rows["X2"].latch_ns == rows["X"].latch_ns
    assert set(rows_of(run_nc(measure, rig, base="gantry-x.toml"))) == {"X"}


@pytest.mark.long
def test_an_axis_that_turns_counts_degrees(run_nc: RunNc) -> None:
    """The cam begins at 102 degrees and lets go 0.02 before it, on the way back."""
    rig = SWITCH.format(axis="C", low=102, plant="table")
    program = "N10 G1 C104.5 F600\nN20 G1 C100 F600"
    out = run_nc(program, rig, "drive:worm.input_delay_us=500", base="fixed-stop-rotary.toml")
    up, down = rows_of(out)["C"], rows_of(out, level=False)["C"]
    assert up.load_mm == pytest.approx(102.0, abs=1e-7)
    assert down.load_mm == pytest.approx(101.98, abs=1e-7)
    assert down.latch_load_mm == pytest.approx(101.98 - 10.0 * 5e-4, abs=1e-5)


@pytest.mark.long
def test_the_terminal_of_a_plc_has_the_instant_of_its_stamp(run_nc: RunNc) -> None:
    """Filter of 20 us; stamps in steps of 1 us of a clock that is 7 us ahead, believed to be 5."""
    out = run_nc(
        "N10 G100 Z99 F600",
        "",
        "plant:z.position_start_mm=102",
        "plc:terminal.filter_us=20",
        "plc:terminal.stamp_resolution_ns=1000",
        "plc:clock_offset_ns=7000",
        "plc:assumed_offset_ns=5000",
        base="plc-timestamp.toml",
    )
    row = rows_of(out)["Z"]
    assert row.read_by == "terminal"
    stamp_ns = (row.edge_ns + 27_000) // 1000 * 1000
    assert row.latch_ns == stamp_ns - 5000
    since_s = (row.latch_ns - row.edge_ns) * 1e-9
    assert way_mm(row.load_mm, row.latch_load_mm) == pytest.approx(-10.0 * since_s, abs=1e-6)


@pytest.mark.long
@pytest.mark.parametrize(
    "habits",
    [
        ("input_filter_us=30", "input_delay_us=100"),
        ("delay_compensation_us=150", "input_delay_us=100"),
        ("latch=sampled", "input_delay_us=100"),
        ("latch=sampled", "input_delay_us=10", "delay_compensation_us=90", "input_filter_us=5"),
    ],
)
def test_what_a_drive_stores_is_the_truth_of_its_data_sheet(
    run_nc: RunNc, habits: tuple[str, ...]
) -> None:
    """The truth knows nothing of the drive; both agree to the increment of 9.5 nm."""
    given = [f"drive:servo.{habit}" for habit in habits]
    out = run_nc(
        "N10 G100 Z98 F600", "", *given, "plant:z.position_start_mm=102", base="probe-z.toml"
    )
    (run,) = out.facts.runs
    row = rows_of(out)["Z"]
    assert abs(way_mm(row.latch_motor_mm, run.latched_mm["Z"])) <= 10e-6
    assert row.latch_ns == out.facts.axes["Z"].latches[0].time_ns
    assert abs(way_mm(row.motor_mm, row.latch_motor_mm)) > 1e-4
