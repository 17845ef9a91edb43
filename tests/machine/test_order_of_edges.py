"""Edges at one instant in their order, slaves of several masters, and inputs with one signal."""

import pytest
from tests.machine.test_edge_truth import Axis, Bench, even, watcher

from axisrig.bench.machine.recording.edge_log import Watcher, watchers_of
from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.kernel.time.clock import MS, US

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts


def axes_of(names: str) -> dict[str, Axis]:
    """Axes that stand 100 mm apart, in this order."""
    return {name: Axis(even(0.1 * number, 0.01)) for number, name in enumerate(names)}


def test_edges_of_one_instant_are_by_signal_then_axis_then_reader() -> None:
    """Signals by name, axes as the rig has them (Z before A), the drive before the terminal."""
    times = LatchTimes(delay_ns=100 * US)
    watching = [
        Watcher(name, times, reader) for reader in ("terminal", "drive") for name in ("A", "Z")
    ]
    bench = Bench(axes_of("ZA"), {"two": watching, "one": watching[::-1]})
    bench.at(5 * MS, two=(3 * MS, True), one=(3 * MS, True))
    bench.at(6 * MS, two=(2 * MS, False))  # came to be known later
    seen = [(row.edge_ns // MS, row.probe, row.axis, row.read_by) for row in bench.log.rows()]
    of_axes = [(axis, reader) for axis in "ZA" for reader in ("drive", "terminal")]
    assert seen == [
        (at, probe, *each) for at, probe in ((2, "two"), (3, "one"), (3, "two")) for each in of_axes
    ]


def test_each_slave_follows_its_own_master() -> None:
    """U follows X and V follows Y, whose drives have other delays."""
    bench = Bench(
        axes_of("XUYV"), {"probe": [watcher("X", 400), watcher("Y", 100)]}, {"U": "X", "V": "Y"}
    )
    bench.at(2 * MS, probe=(1 * MS, True))
    assert [(row.axis, row.latch_ns // US) for row in bench.log.rows()] == [
        ("X", 1400), ("U", 1400), ("Y", 1100), ("V", 1100),
    ]  # fmt: skip


def test_a_slave_that_is_simulated_elsewhere_has_no_rows() -> None:
    bench = Bench(axes_of("XV"), {"probe": [watcher("X", 400)]}, {"U": "X", "V": "X"})
    bench.at(2 * MS, probe=(1 * MS, True))
    assert [row.axis for row in bench.log.rows()] == ["X", "V"]


def test_a_coupling_counts_from_the_edge_at_which_it_is_there() -> None:
    slaves: dict[str, str] = {}
    bench = Bench(axes_of("XU"), {"probe": [watcher("X")]}, slaves)
    bench.log = type(bench.log)(
        bench.plant,  # type: ignore[arg-type]
        axes_of("XU"),  # type: ignore[arg-type]
        {"probe": [watcher("X")]},
        lambda masters: {slave: by for slave, by in slaves.items() if by in masters},
    )
    for at, coupled in ((1, {}), (2, {"U": "X"}), (3, {})):
        slaves.clear()
        slaves.update(coupled)
        bench.at((at + 1) * MS, probe=(at * MS, at % 2 == 1))
    assert [(row.edge_ns // MS, row.axis, row.level) for row in bench.log.rows()] == [
        (1, "X", True), (2, "X", False), (2, "U", False), (3, "X", True),
    ]  # fmt: skip


def test_a_latch_of_this_very_instant_has_its_place() -> None:
    bench = Bench(axes_of("Z"), {"probe": [watcher("Z", 500)]})
    bench.at(1 * MS, probe=(800_000, True))
    bench.at(1_300_000)
    (row,) = bench.log.rows()
    assert row.latch_load_mm == pytest.approx(10.0 * 1.3e-3, abs=1e-9)


def test_several_edges_between_two_looks_are_each_noted_once() -> None:
    """A contact that chatters: three in one cycle, none in the next ones, then two more."""
    bench = Bench(axes_of("Z"), {"probe": [watcher("Z")], "other": [watcher("Z")]})
    signal = bench.plant.probes["probe"].signal  # type: ignore[attr-defined]
    for at_us in (100, 200):
        signal.edges.append((at_us * US, at_us == 100))
    bench.at(1 * MS, probe=(300 * US, True))
    bench.at(2 * MS)
    bench.at(3 * MS, other=(2_500 * US, True))
    signal.edges.append((3_100 * US, False))
    bench.at(4 * MS, probe=(3_200 * US, True))
    for _ in range(2):
        found = [(row.probe, row.edge_ns // US, row.level) for row in bench.log.rows()]
        assert found == [
            ("probe", 100, True), ("probe", 200, False), ("probe", 300, True),
            ("other", 2500, True), ("probe", 3100, False), ("probe", 3200, True),
        ]  # fmt: skip


@pytest.mark.parametrize("edge_us", [1000, 1001, 1500, 2000])
def test_motor_and_load_are_looked_up_at_edge_and_latch_each_by_itself(edge_us: int) -> None:
    """Also where an instant is the very end of a step; the latch comes 1 ms after the edge."""
    axis = Axis(even(0.1, 0.02), motor=even(0.3, -0.05), off_m=0.007)
    bench = Bench({"Z": axis}, {"probe": [watcher("Z", 1000)]})
    bench.at(5 * MS, probe=(edge_us * US, True))
    (row,) = bench.log.rows()
    load_mm = [100.0 + 20.0 * at_us * 1e-6 for at_us in (edge_us, edge_us + 1000)]
    motor_mm = [300.0 - 50.0 * at_us * 1e-6 for at_us in (edge_us, edge_us + 1000)]
    assert [row.load_mm, row.latch_load_mm] == pytest.approx(load_mm, abs=1e-9)
    assert [row.motor_mm, row.latch_motor_mm] == pytest.approx(motor_mm, abs=1e-9)
    second_mm = [mm + 7.0 for mm in load_mm]
    assert [row.second_mm, row.latch_second_mm] == pytest.approx(second_mm, abs=1e-9)


def test_one_signal_at_two_inputs_of_the_terminal_is_watched_once() -> None:
    """By each axis; a signal at another input by each axis too, and none by the drive."""

    class Of:
        """Anything with attributes."""

        def __init__(self, **more: object) -> None:
            self.__dict__.update(more)

    terminal = Of(
        inputs={1: "probe", 2: "other", 3: "probe"}, stamp_resolution_ns=1, filter_us=0.0,
        stamp_jitter_ns=0, is_on_can=False,
    )  # fmt: skip
    task = Of(
        terminal=terminal, clock_offset_ns=0, clock_drift_ppm=0.0, assumed_offset_ns=0,
        assumed_drift_ppm=0.0,
    )  # fmt: skip
    facts = Of(latch=LatchTimes())
    axis = {name: Of(drive="servo", signals={}) for name in "XZ"}
    drive = {"servo": Of(facts=lambda: facts)}
    found = watchers_of(Of(rig=Of(axis=axis, drive=drive, plc_task=task)), "XZ")  # type: ignore[arg-type]
    assert {name: [(one.axis, one.read_by) for one in each] for name, each in found.items()} == {
        name: [("X", "terminal"), ("Z", "terminal")] for name in ("probe", "other")
    }
