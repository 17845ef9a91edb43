"""What a rig makes of its lines, buses and clocks, key by key: each key changes its own value."""

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.machine.made_rigs import above, settings_of

from axisrig.bench.bus.journal import Journal
from axisrig.bench.drive.ethercat.node import SlaveSettings
from axisrig.bench.machine.canopen.nodes import build_segments
from axisrig.bench.machine.ethercat.line import line_settings
from axisrig.bench.machine.ethercat.line_faults import LineFaults
from axisrig.bench.machine.ethercat.line_terminal import LineTerminal, register_inputs
from axisrig.bench.machine.ethercat.slaves import slave_of, terminal_slave
from axisrig.bench.machine.pacing import Hardware, master_scheduler
from axisrig.bench.machine.recording.edge_log import stamp_times, watchers_of
from axisrig.bench.oracles.latch.instant import LatchTimes
from axisrig.bench.oracles.sources.chain import Stamps
from axisrig.bench.rig.reading.plc_task import PlcTaskTable, TerminalTable
from axisrig.kernel.drives.ethercat.settings import LineSettings
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.time.clock import MS, US
from axisrig.kernel.time.scheduler import new_scheduler

# --- lines

KEYS: dict[str, tuple[str, Any]] = {
    "frame_us=12.5": ("frame_ns", 12_500),
    "shift_us=250": ("shift_ns", 250_000),
    "dc=false": ("has_clocks", False),
    "drift_compensation=false": ("compensates_drift", False),
    "delay_compensation=false": ("compensates_delay", False),
    "clock_limit_us=2.5": ("clock_limit_ns", 2500),
    "assumed_sample_us=Y=-7.5": ("sample_ns", {"X": 0, "Y": -7500, "Z": 0}),
    "sample_us=Z=3": ("sample_ns", {"X": 0, "Y": 0, "Z": 3000}),
}


@pytest.mark.parametrize("key", KEYS)
def test_a_key_of_a_line_changes_what_its_master_knows_and_nothing_else(key: str) -> None:
    field, value = KEYS[key]
    plain = line_settings(settings_of("probe-xyz-ethercat.toml"), "ec1")
    found = line_settings(settings_of("probe-xyz-ethercat.toml", f"bus:ec1.{key}"), "ec1")
    assert getattr(found, field) == value != getattr(plain, field)
    names = LineSettings.__dataclass_fields__
    assert [n for n in names if getattr(found, n) != getattr(plain, n)] == [field]
    assert (plain.name, plain.period_ns, plain.watches_clocks) == ("ec1", MS, False)


@pytest.mark.parametrize(
    ("rig", "watches"),
    [("plc-timestamp-line.toml", True), ("plc-timestamp-ethercat.toml", True),
     ("probe-z-ethercat.toml", False)],
)  # fmt: skip
def test_clocks_are_watched_where_stamps_are_compared_with_them(rig: str, watches: bool) -> None:
    found = line_settings(settings_of(rig), "ec1")
    assert found.watches_clocks is found.reads_differences is watches


def test_each_slave_has_the_clock_of_its_own_axis() -> None:
    changes = ("clock_start_us=X=10 Z=-20", "drift_ppm=Y=30 Z=-5", "sample_us=X=-4")
    settings = settings_of("probe-xyz-ethercat.toml", *(f"bus:ec1.{one}" for one in changes))
    found = {axis: slave_of(settings, axis, serial) for serial, axis in enumerate("XYZ", 7)}
    assert found == {
        "X": SlaveSettings(7, start_ns=10_000, sample_ns=-4000),
        "Y": SlaveSettings(8, drift_ppm=30.0),
        "Z": SlaveSettings(9, start_ns=-20_000, drift_ppm=-5.0),
    }
    assert slave_of(settings_of("probe-z.toml"), "Z", 3) == SlaveSettings(3)  # it is on CAN


@pytest.mark.parametrize(
    ("key", "field"), [("clock_start_us", "start_ns"), ("sample_us", "sample_ns")]
)
@pytest.mark.parametrize(("us", "ns"), [("12.5", 12_500), ("-0.75", -750), ("0.001", 1)])
def test_times_of_a_slave_are_whole_nanoseconds(key: str, field: str, us: str, ns: int) -> None:
    """They need not be whole microseconds."""
    settings = settings_of("probe-xyz-ethercat.toml", f"bus:ec1.{key}=Y={us}")
    assert getattr(slave_of(settings, "Y", 1), field) == ns
    assert getattr(slave_of(settings, "X", 1), field) == 0


@pytest.mark.parametrize(("edge", "mode"), [("first", b"\3"), ("last", b"\0")])
def test_the_control_reads_the_registers_of_the_terminal(edge: Any, mode: bytes) -> None:
    """09AE to 09CF of the slave behind the drives; bits 0 and 1 of 09A8 and 09A9: single event."""
    settings = settings_of("plc-timestamp-line.toml")
    found = register_inputs(settings, "ec1", TerminalTable(segment="ec1", stamp_edge=edge))
    assert (found.axis, found.node_id, found.first, found.size) == ("terminal", 2, 0x09AE, 34)
    assert found.writes == (("LATCH0_CONTROL", mode), ("LATCH1_CONTROL", mode))
    assert found.identity == {1: 0, 2: 401}  # vendor and product, docs/ethercat.md


def terminal(**keys: Any) -> tuple[LineTerminal, Any]:
    clock: Any = SimpleNamespace(now_ns=0)
    table = TerminalTable(segment="ec1", input_1="a", input_2="b", **keys)
    slave: Any = SimpleNamespace()
    return LineTerminal(slave, table, clock, MS), clock


def test_a_terminal_shows_level_and_stamps_of_each_input() -> None:
    """Status with the level in bit 2, then the rising and the falling edge of each, 64 bits."""
    found, _ = terminal()
    times = [11, 12, (1 << 63) + 13, 14]
    found.taken(bytes([0b0100, 0b1011]) + b"".join(t.to_bytes(8, "little") for t in times))
    first, second = found.image[1], found.image[2]
    assert (first.input, first.latch_pos_ns, first.latch_neg_ns) == (True, 11, 12)
    assert (second.input, second.latch_pos_ns, second.latch_neg_ns) == (False, times[2], 14)


def test_a_terminal_is_lost_after_more_frames_than_may_be_missing() -> None:
    found, clock = terminal(missing_cycles=2)
    assert found.wc_state == 1  # nothing has come yet
    clock.now_ns = 5 * MS
    found.taken(bytes(34))
    states = []
    for now_ns in (5 * MS, 8 * MS, 8 * MS + 1):
        clock.now_ns = now_ns
        states.append(found.wc_state)
    assert states == [0, 0, 1]
    found.taken(bytes(34))
    assert found.wc_state == 0


@pytest.mark.interpreted
def test_faults_of_a_line_are_those_of_cyclic_frames_and_of_one_slave() -> None:
    """The index of the first datagram of a cyclic frame is 0x80 and more (FIRST_INDEX)."""
    calls: list[tuple[Any, ...]] = []

    def slave(name: str) -> Any:
        return SimpleNamespace(
            states=SimpleNamespace(fall=lambda *words: calls.append((name, *words))),
            jump=lambda by_ns: calls.append((name, by_ns)),
        )

    segment: Any = SimpleNamespace(passes=[], breaks=[])
    faults = LineFaults(segment, {"X": slave("X"), "Z": slave("Z")})
    faults.fall("Z", AlState.SAFEOP, "SYNC_ERROR")
    faults.jump("X", -50)
    assert calls == [("Z", AlState.SAFEOP, "SYNC_ERROR"), ("X", -50)]
    cyclic, other = bytearray(60), bytearray(60)
    cyclic[17], other[17] = 0x80, 0x7F
    faults.disturb(lambda _: 7)
    faults.disturb(lambda _: None)
    assert [passes(cyclic) for passes in segment.passes] == [7, None]
    assert [passes(other) for passes in segment.passes] == [0, 0]
    asked: list[bool] = []

    def falls() -> bool:
        asked.append(True)
        return True

    faults.breaks("Z", falls)
    (breaks,) = segment.breaks
    assert [breaks(cyclic, 1), breaks(cyclic, 0), breaks(other, 1)] == [True, False, False]
    assert asked == [True]  # what does not count is not asked


# --- buses


@pytest.fixture
def opened() -> Iterator[ExitStack]:
    with ExitStack() as stack:
        yield stack


@pytest.mark.parametrize(("change", "recovers"), [("stay", False), ("recover", True)])
def test_a_bus_is_built_by_its_table(change: str, recovers: bool, opened: ExitStack) -> None:
    """After bus-off a controller comes back after 128 times 11 recessive bits, 1.408 ms, or not."""
    clock = new_scheduler()
    settings = settings_of(
        "probe-xyz.toml", f"bus:can2.bus_off={change}", "bus:can3.bitrate=800000"
    )
    segments = build_segments(settings, clock, Journal(), [], opened)
    assert [*segments] == ["can1", "can2", "can3"]
    assert [s.bitrate for s in segments.values()] == [1_000_000, 1_000_000, 800_000]
    port = segments["can2"].port("one")
    segments["can2"].port("other")
    port.force_bus_off()
    clock.run_until(5 * MS)
    assert (str(port.error_state) == "error active") is recovers


@pytest.mark.parametrize(
    ("text", "wait_ns"),
    [("", 0), ("[realtime]\nwait_ms = 2.5", 2_500_000), ("[realtime]\nwait_ms = 0", 0)],
)
def test_a_run_outside_is_paced_by_its_cycle(tmp_path: Path, text: str, wait_ns: int) -> None:
    """A quarter of 2 ms may be lost; answers are due at the NC cycle."""
    more = f"[cycle]\nperiod_us = 2000\ncycle_offset_us = 900\n{text}"
    more += "\nlate_us = 40.5" if "realtime" in text else "\n[realtime]\nlate_us = 40.5"
    settings = settings_of(above(tmp_path, "probe-z.toml", more))
    times: Any = SimpleNamespace(monotonic_ns=lambda: 0, pause=lambda _: None)
    clock = master_scheduler(settings, Hardware(times))
    assert (clock.pacing.slip_ns, clock.pacing.answer_ns) == (500 * US, 900 * US)
    assert clock.pacing.wait_ns == wait_ns
    assert clock.deadlines.late_ns == 40_500


@pytest.mark.parametrize(("interface", "wait_ms"), [("socketcan", 0), ("gs_usb", 5), ("slcan", 50)])
def test_without_a_key_the_wait_for_answers_is_that_of_the_interface(
    tmp_path: Path, interface: str, wait_ms: int
) -> None:
    text = f'[segment.can1]\ninterface = "{interface}"\nchannel = "x"'
    times: Any = SimpleNamespace(monotonic_ns=lambda: 0, pause=lambda _: None)
    clock = master_scheduler(settings_of(above(tmp_path, "probe-z.toml", text)), Hardware(times))
    assert clock.pacing.wait_ns == wait_ms * MS  # interfaces.csv
    for own_ms in (0, 7):  # 0 is a key too: nobody is waited for
        own = f"{text}\n[realtime]\nwait_ms = {own_ms}"
        settings = settings_of(above(tmp_path, "probe-z.toml", own))
        assert master_scheduler(settings, Hardware(times)).pacing.wait_ns == own_ms * MS


@pytest.mark.parametrize("first", ["slcan", "socketcan"])
def test_of_several_buses_the_one_that_takes_longest_is_waited_for(
    tmp_path: Path, first: str
) -> None:
    """slcan 50 ms, socketcan 0: both on a line of their own, in either order."""
    second = {"slcan": "socketcan", "socketcan": "slcan"}[first]
    text = "\n".join(
        f'[segment.{name}]\ninterface = "{interface}"\nchannel = "{name}"'
        for name, interface in (("can1", first), ("can2", second), ("can3", "socketcan"))
    )
    times: Any = SimpleNamespace(monotonic_ns=lambda: 0, pause=lambda _: None)
    settings = settings_of(above(tmp_path, "probe-xyz.toml", text))
    assert master_scheduler(settings, Hardware(times)).pacing.wait_ns == 50 * MS


@pytest.mark.parametrize(("period_us", "offset_us", "late_us"), [(1000, 600, 50), (2000, 900, 7.5)])
def test_the_pace_of_a_rig_is_a_quarter_of_its_cycle_and_its_offset(
    tmp_path: Path, period_us: int, offset_us: int, late_us: float
) -> None:
    """A cycle that is late by more than a quarter moves the plan; answers come until the offset."""
    text = (
        f"[cycle]\nperiod_us = {period_us}\ncycle_offset_us = {offset_us}\n"
        f'[realtime]\nlate_us = {late_us}\n[segment.can1]\ninterface = "slcan"\nchannel = "x"'
    )
    times: Any = SimpleNamespace(monotonic_ns=lambda: 0, pause=lambda _: None)
    clock = master_scheduler(settings_of(above(tmp_path, "probe-z.toml", text)), Hardware(times))
    assert (clock.pacing.slip_ns, clock.pacing.answer_ns) == (period_us * 250, offset_us * 1000)
    assert clock.deadlines.late_ns == round(late_us * 1000)
    assert clock.pacing.sync_period_ns is None


# --- who watches an edge


def test_an_axis_watches_each_signal_of_its_drive_once_and_all_that_of_the_terminal() -> None:
    """X, Y and Z have the one probe at both inputs."""
    settings = settings_of("probe-xyz.toml", "drive:servo.input_delay_us=5")
    found = watchers_of(settings, ["X", "Z"])
    assert [*found] == ["probe"]
    watching = [(one.axis, one.read_by, one.times.delay_ns) for one in found["probe"]]
    assert watching == [("X", "drive", 5000), ("Z", "drive", 5000)]
    of_plc = settings_of("plc-timestamp.toml")
    assert of_plc.rig.plc_task is not None
    assert of_plc.rig.plc_task.terminal is not None
    wired = set(of_plc.rig.plc_task.terminal.inputs.values())
    at_terminal = watchers_of(of_plc, ["Z"])
    for name in wired:
        (watcher,) = (one for one in at_terminal[name] if one.read_by == "terminal")
        assert (watcher.axis, watcher.times) == ("Z", stamp_times(of_plc.rig.plc_task))


def test_a_probe_at_drives_and_at_the_terminal_is_watched_by_both() -> None:
    """Drives first, in the order that is asked for; at the terminal it may be measured by each."""
    settings = settings_of("probe-xyz.toml", "drive:servo.input_delay_us=5")
    terminal = {"input_1": "probe", "input_2": "other", "filter_us": 3.5}
    task = PlcTaskTable.model_validate({"period_us": 4000, "program": "p.py", "terminal": terminal})
    table = settings.rig.model_copy(update={"plc_task": task})
    found = watchers_of(SimpleNamespace(rig=table), ["Z", "X"])  # type: ignore[arg-type]
    assert {
        name: [(one.axis, one.read_by, one.times.delay_ns) for one in watching]
        for name, watching in found.items()
    } == {
        "probe": [
            ("Z", "drive", 5000), ("X", "drive", 5000),
            ("Z", "terminal", 3500), ("X", "terminal", 3500),
        ],
        "other": [("Z", "terminal", 3500), ("X", "terminal", 3500)],
    }  # fmt: skip


def test_a_terminal_makes_a_stamp_of_an_edge_and_a_node_on_can_none() -> None:
    numbers = {"clock_offset_ns": 11, "clock_drift_ppm": 1.5, "assumed_offset_ns": 12,
               "assumed_drift_ppm": 2.5}  # fmt: skip
    of_terminal = {"filter_us": 3.5, "stamp_resolution_ns": 10, "stamp_jitter_ns": 20}
    task = PlcTaskTable.model_validate(
        {"period_us": 4000, "program": "p.py", "terminal": of_terminal, **numbers}
    )
    assert stamp_times(task) == LatchTimes(3500, 0, 0, 20, Stamps(10, 11, 1.5, 12, 2.5))
    node = {"segment": "can1", "node": 5, "filter_us": 3.5}
    on_can = PlcTaskTable.model_validate({"period_us": 4000, "program": "p.py", "terminal": node})
    assert stamp_times(on_can) == LatchTimes(3500)


@pytest.mark.interpreted
@pytest.mark.parametrize(("silent_ms", "off_ns"), [("0", 0), ("2.5", 2_500_000), (None, None)])
def test_a_terminal_of_a_line_is_silent_from_its_instant_on(
    tmp_path: Path, silent_ms: str | None, off_ns: int | None
) -> None:
    text = "" if silent_ms is None else f"[plc.terminal]\nsilent_from_ms = {silent_ms}"
    settings = settings_of(above(tmp_path, "plc-timestamp-line.toml", text))
    task = settings.rig.plc_task
    assert task is not None
    assert task.terminal is not None
    signal = SimpleNamespace(edges=[], level=False)
    beside: Any = SimpleNamespace(signals=dict.fromkeys(task.terminal.inputs.values(), signal))
    clock = new_scheduler()
    segment = next(iter(settings.segment))
    slave = terminal_slave(settings, segment, clock, beside, lambda _: None, 1)
    assert slave is not None
    for at_ns in (0, 2_499_999, 2_500_000, 3 * MS):
        clock.run_until(at_ns)
        assert slave.is_on is (off_ns is None or at_ns < off_ns)
