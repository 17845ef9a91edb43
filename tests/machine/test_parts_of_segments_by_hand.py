"""Parts of a machine that carry segments: each answers for its own lines, buses and axes."""

from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.load import LoadNow
from axisrig.bench.machine import cia402, families
from axisrig.bench.machine.canopen import family as can
from axisrig.bench.machine.cyclic import family as cyclic
from axisrig.bench.machine.ethercat import family as ethercat
from axisrig.bench.machine.ethercat.family import EthercatLines
from axisrig.bench.machine.ethercat.line_faults import LineFaults
from axisrig.bench.machine.ethercat.line_meter import LineMeter
from axisrig.bench.machine.ethercat.line_terminal import inputs_of
from axisrig.bench.record.axes import DriveState
from axisrig.kernel.drives.ethercat.frames import INDEX_PLACE
from axisrig.kernel.drives.ethercat.master import FIRST_INDEX
from axisrig.kernel.drives.power import Power
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.profiles.ethercat.tables import AlState
from axisrig.kernel.time.clock import MS

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

WIRED = {"X": "one", "Y": "two", "Z": "two", "W": "other"}


def bench() -> Any:
    """Axes on two segments of a part, and one on a segment of somebody else; it is 250 ms."""
    axes = {name: SimpleNamespace(segment=segment) for name, segment in WIRED.items()}
    settings = SimpleNamespace(rig=SimpleNamespace(axis=axes))
    return SimpleNamespace(settings=settings, scheduler=SimpleNamespace(now_ns=250 * MS))


def part_of(kind: Any, segments: dict[str, Any]) -> Any:
    """A part that has been installed with these segments or lines."""
    part = kind.__new__(kind)
    part._bench = bench()
    part.nodes = {name: f"node {name}" for name in "XYZ"}
    part.lines = part.segments = segments
    return part


@pytest.mark.parametrize(
    ("module", "kind", "table"),
    [(can, "CanBuses", "ON_CAN"), (ethercat, "EthercatLines", "ON_LINES"),
     (cyclic, "CyclicSegments", "ON_IMAGES")],
)  # fmt: skip
def test_a_fault_is_built_in_where_its_segment_or_the_one_of_its_axis_is(
    monkeypatch: pytest.MonkeyPatch, module: Any, kind: str, table: str
) -> None:
    built: list[tuple[Any, ...]] = []

    def make(*words: Any) -> str:
        built.append(words)
        return "act"

    monkeypatch.setattr(module, table, {"some": make, "other": None})
    segments: Any = {name: SimpleNamespace(faults=f"faults of {name}") for name in ("one", "two")}
    part = part_of(getattr(module, kind), segments)
    for axis, segment, on in (
        ("", "one", "one"), ("", "two", "two"), ("X", "", "one"), ("Z", "", "two"),
        ("W", "", None), ("", "other", None),
    ):  # fmt: skip
        fault: Any = SimpleNamespace(kind="some", axis=axis, segment=segment)
        found = part.build_fault(fault, "numbers", "record")
        if on is None:
            assert (found, built) == (None, [])
            continue
        ((place, *words),) = built
        built.clear()
        assert (found, words) == ("act", [fault, "numbers", "record"])
        assert place.nodes is part.nodes
        one = segments[on]
        of_part = {"CanBuses": lambda at: at.segments is part.segments,
                   "EthercatLines": lambda at, one=one: at.line is one.faults,
                   "CyclicSegments": lambda at, one=one: at.segment is one}  # fmt: skip
        assert of_part[kind](place), (axis, segment)
        assert place.clock is part._bench.scheduler


def test_the_first_part_that_has_the_segment_builds_a_fault_in() -> None:
    asked: list[str] = []

    def part(name: str, act: str | None) -> Any:
        def build(*words: Any) -> str | None:
            asked.append(name)
            assert words == ("fault", "numbers", "record")
            return act

        return SimpleNamespace(build_fault=build)

    parts: Any = [part("a", None), part("b", "act of b"), part("c", "act of c")]
    given: Any = ("fault", "numbers", "record")
    assert families.build_fault(parts, *given) == "act of b"
    assert asked == ["a", "b"]


class Meter:
    """What has passed on a line; loads differ by their span."""

    def __init__(self, number: int) -> None:
        self.back, self.wrong, self.wrong_in_a_row = number, number + 1, number + 2
        self.changes = [f"change {number}"]
        self._base = 100.0 * number

    def load_pct(self, now_ns: int) -> float:
        return self._base + now_ns / MS / 1000

    def worst_pct(self, span_ns: int, now_ns: int) -> float:
        return self._base + span_ns / MS + now_ns / MS / 1000

    def recent_pct(self, now_ns: int, span_ns: int) -> float:
        return self.worst_pct(span_ns, now_ns)


def line_of(number: int, axes: str) -> Any:
    """A line whose numbers begin with `number`; its last slave has fallen."""
    slaves = {
        name: SimpleNamespace(states=SimpleNamespace(state=AlState.OP, code=0)) for name in axes
    }
    slaves[axes[-1]].states = SimpleNamespace(state=AlState.SAFEOP, code=0x1B)
    master = SimpleNamespace(
        frames=number + 4, image=SimpleNamespace(counter=number + 5), clocks_off_ns=number + 6,
        line=SimpleNamespace(clock_limit_ns=number + 7, reads_differences=number == 10),
    )  # fmt: skip
    carrier = SimpleNamespace(sampled_ns=lambda axis: f"{axis} of {number}")
    segment = SimpleNamespace(frames=number + 8, lost=number + 9)
    return SimpleNamespace(
        slaves=slaves, master=master, carrier=carrier, segment=segment, terminal=None
    )


def test_each_line_has_its_own_figures_schedule_and_clocks(monkeypatch: pytest.MonkeyPatch) -> None:
    lines = {"one": line_of(10, "X"), "two": line_of(20, "YZ")}
    part = part_of(EthercatLines, lines)
    part._meters = {"one": Meter(1), "two": Meter(2)}
    cycles = {"one": SimpleNamespace(period_ns=1_000_000, wire_ns=10_000),
              "two": SimpleNamespace(period_ns=2_000_000, wire_ns=12_500)}  # fmt: skip
    monkeypatch.setattr(ethercat, "schedule_of", lambda settings, name: cycles[name])
    monkeypatch.setattr(ethercat, "overloads", lambda settings: {"two": "too long"})
    found = part.figures()
    assert [one.segment for one in found] == ["one", "two"]
    assert [one.overload for one in found] == ["", "too long"]
    assert [one.load_pct for one in found] == [100.25, 200.25]
    assert [one.load_100ms_pct for one in found] == [200.25, 300.25]
    assert [one.load_1ms_pct for one in found] == [101.25, 201.25]
    assert [(one.frames, one.error_frames) for one in found] == [(18, 19), (28, 29)]
    assert [one.changes for one in found] == [("change 1",), ("change 2",)]
    assert {one.bitrate for one in found} == {100_000_000}
    of_lines = [one.line for one in found]
    assert [(one.period_us, one.wire_us) for one in of_lines] == [(1000.0, 10.0), (2000.0, 12.5)]
    assert [(one.sent, one.back, one.counter) for one in of_lines] == [(14, 1, 15), (24, 2, 25)]
    assert [(one.wrong, one.wrong_in_a_row) for one in of_lines] == [(2, 3), (3, 4)]
    assert [name for name, _ in of_lines[1].slaves] == ["Y", "Z"]
    (up, down) = (words for _, words in of_lines[1].slaves)
    assert up == "OP"
    assert down.lower().startswith("safe")
    assert "watchdog" in down.lower()  # ETG.1000.6: code 001B
    shown = part.shown()
    span_ms = ethercat.LOAD_SPAN_NS / MS
    assert [one["segment"] for one in shown] == ["one", "two"]
    assert [one["load_pct"] for one in shown] == [100.25 + span_ms, 200.25 + span_ms]
    assert [(one["frames"], one["error_frames"]) for one in shown] == [(18, 19), (28, 29)]
    assert [one["line"]["sent"] for one in shown] == [14, 24]
    assert {(one["is_outside"], one["lost"], one["bitrate"]) for one in shown} == {
        (False, None, 100_000_000)
    }
    # Of the line of the axis; one that does not read differences has no limit
    assert [part.sampled_ns(axis, 5) for axis in "XZ"] == ["X of 10", "Z of 20"]
    assert [part.clocks_off_ns(axis) for axis in "XZ"] == [16, 26]
    assert [part.clock_limit_ns(axis) for axis in "XZ"] == [17, None]
    assert part.terminal(lambda _: None) is None
    lines["two"].terminal = "terminal"
    assert part.terminal(lambda _: None) == "terminal"


class Outside(SimpleNamespace):
    """A bus at a real interface."""


class Answering(Outside):
    """One that notes which answers to a SYNC it is to wait for."""

    def expect(self, cob_ids: Any) -> None:
        self.expected = sorted(cob_ids)


def test_a_real_bus_waits_for_the_telegrams_that_its_own_drives_answer_a_sync_with(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Transmission type 1, to the control; of X on bus one, of Y and Z on bus two, where Z is
    simulated here and answers by itself."""
    monkeypatch.setattr(can, "OutsideSegment", Answering)
    monkeypatch.setattr(can, "outside_axes", lambda _: {"X", "Y"})

    def telegram(name: str, base: int, transmission: int) -> Any:
        return SimpleNamespace(
            name=name, transmission=transmission, cob_id=lambda node: base + node
        )

    telegrams = {
        one.name: one
        for one in (
            telegram("RPDO1", 0x200, 1), telegram("TPDO1", 0x180, 1), telegram("TPDO2", 0x280, 254),
            telegram("TPDO3", 0x380, 1), telegram("TPDO4", 0x480, 0),
        )
    }  # fmt: skip
    buses = {"one": Answering(), "two": Answering(), "three": SimpleNamespace()}
    part = part_of(can.CanBuses, buses)
    part.links = {
        name: SimpleNamespace(node_id=node, telegrams=telegrams)
        for node, name in enumerate("XYZW", 1)
    }
    part._expect_answers()
    assert buses["one"].expected == [0x181, 0x381]
    assert buses["two"].expected == [0x182, 0x382]


def port(name: str, tec: int, rec: int, state: ErrorState = ErrorState.ACTIVE) -> Any:
    return SimpleNamespace(port_name=name, tec=tec, rec=rec, error_state=state)


def test_each_bus_shows_its_load_and_every_node_that_has_counted_an_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Transmit errors, receive errors or both; no longer once both are 0."""
    monkeypatch.setattr(can, "OutsideSegment", Outside)
    wanted: list[tuple[int, int]] = []

    def bus(kind: Any, number: int, ports: list[Any], **more: Any) -> Any:
        def load_now(now_ns: int, span_ns: int) -> LoadNow:
            wanted.append((now_ns, span_ns))
            return LoadNow(number, number + 1, number / 100)

        return kind(bitrate=1000 * number, ports=ports, load_now=load_now, **more)

    ports = [
        port("cnc", 136, 0, ErrorState.PASSIVE), port("X", 0, 7), port("Y", 0, 0), port("Z", 8, 1)
    ]  # fmt: skip
    buses = {
        "one": bus(SimpleNamespace, 10, ports),
        "two": bus(Outside, 25, [port("W", 0, 0)], lost=""),
        "three": bus(Outside, 50, [port("V", 1, 0)], lost="unplugged"),
    }
    part = part_of(can.CanBuses, buses)
    found = part.shown()
    assert wanted == 3 * [(250 * MS, can.LOAD_SPAN_NS)]
    assert [one.pop("counters") for one in found] == [
        [
            {"node": "cnc", "tec": 136, "rec": 0, "state": str(ErrorState.PASSIVE)},
            {"node": "X", "tec": 0, "rec": 7, "state": str(ErrorState.ACTIVE)},
            {"node": "Z", "tec": 8, "rec": 1, "state": str(ErrorState.ACTIVE)},
        ],
        [],
        [{"node": "V", "tec": 1, "rec": 0, "state": str(ErrorState.ACTIVE)}],
    ]
    names = ("segment", "bitrate", "is_outside", "lost", "frames", "error_frames", "load_pct")
    assert [tuple(one[name] for name in names) for one in found] == [
        ("one", 10_000, False, None, 10, 11, 10.0),
        ("two", 25_000, True, "", 25, 26, 25.0),
        ("three", 50_000, True, "unplugged", 50, 51, 50.0),
    ]
    ports[0].tec, ports[1].rec, ports[2].rec = 0, 0, 1
    assert [one["node"] for one in part.shown()[0]["counters"]] == ["Y", "Z"]


def test_cyclic_segments_have_the_warnings_of_every_drive_in_their_order() -> None:
    part = part_of(cyclic.CyclicSegments, {})
    warned = {"X": [], "Y": ["first", "second"], "Z": (), "W": ["third"]}
    part.ends = {axis: SimpleNamespace(warnings=found) for axis, found in warned.items()}
    assert part.warnings == ["first", "second", "third"]


@pytest.mark.parametrize("kind", [can.CanBuses, EthercatLines, cyclic.CyclicSegments])
@pytest.mark.parametrize("state", State)
def test_each_state_of_a_drive_is_noted_and_what_is_trouble_is_marked(
    kind: Any, state: State
) -> None:
    """CiA 402: a quick stop, the reaction to a fault and the fault are no usual way."""
    part = part_of(kind, {})
    part.states = {axis: [] for axis in "XY"}
    for now_ns in (3, 250 * MS):
        part._bench.scheduler.now_ns = now_ns
        part._note_state("Y", state)
    is_trouble = state.name in ("QUICK_STOP_ACTIVE", "FAULT_REACTION_ACTIVE", "FAULT")
    assert part.states == {
        "X": [], "Y": [DriveState(at_ns, state.name, is_trouble) for at_ns in (3, 250 * MS)]
    }  # fmt: skip


def test_a_log_of_a_line_has_its_name_whatever_kinds_of_logs_are_asked_for() -> None:
    logs = [Path("runs") / name for name in ("a.b-1.blf", "a.b-1.log")]
    found = ethercat._files(logs, ["one", "two"])
    assert found == [("one", Path("runs/a.b-1@one.pcapng")), ("two", Path("runs/a.b-1@two.pcapng"))]
    assert ethercat._files([], ["one"]) == []
    assert ethercat._files(logs, []) == []


def test_a_terminal_of_a_line_has_what_is_wired_to_each_input() -> None:
    signals: Any = {"a": "signal a", "b": "signal b"}
    for wired, found in (
        ({1: "a", 2: "b"}, ("signal a", "signal b")), ({2: "a"}, (None, "signal a")),
        ({1: "b"}, ("signal b", None)), ({2: "b", 1: "a"}, ("signal a", "signal b")),
    ):  # fmt: skip
        table: Any = SimpleNamespace(inputs=wired)
        assert inputs_of(table, signals) == found


def test_faults_of_a_line_are_asked_once_for_each_cyclic_frame_at_their_own_slave() -> None:
    """Neither for frames beside the cycle nor at other slaves; by the place on the line."""
    segment: Any = SimpleNamespace(passes=[], breaks=[])
    called: list[tuple[Any, ...]] = []
    slaves: Any = {
        name: SimpleNamespace(
            states=SimpleNamespace(fall=lambda *words, name=name: called.append((name, *words))),
            jump=lambda by_ns, name=name: called.append((name, by_ns)),
        )
        for name in "XYZ"
    }
    faults = LineFaults(segment, slaves)
    cyclic_frame, other_frame = bytearray(60), bytearray(60)
    cyclic_frame[INDEX_PLACE], other_frame[INDEX_PLACE] = FIRST_INDEX, FIRST_INDEX - 1
    asked: list[str] = []

    def falls(name: str, answer: bool) -> bool:
        asked.append(name)
        return answer

    for name, answer in (("Y", False), ("Z", True)):
        faults.breaks(name, partial(falls, name, answer))
    for frame, broken_at in ((cyclic_frame, [2]), (other_frame, [])):
        asked.clear()
        found = [n for n in range(3) for breaks in segment.breaks if breaks(frame, n)]
        assert (found, asked) == (broken_at, ["Y", "Z"] if broken_at else [])
    faults.disturb(lambda frame: None)
    (passes,) = segment.passes
    assert (passes(cyclic_frame), passes(other_frame)) == (None, 0)
    faults.fall("Y", AlState.SAFEOP, "code")
    faults.jump("Z", -7)
    assert called == [("Y", AlState.SAFEOP, "code"), ("Z", -7)]


def test_states_of_a_slave_are_noted_from_its_first_operation_on() -> None:
    """Each change once; in trouble is whoever is not in OP, also without a code (ETG.1000.6)."""
    observers: dict[str, list[Any]] = {"X": [], "Y": []}
    nodes = {
        name: SimpleNamespace(states=SimpleNamespace(observers=each))
        for name, each in observers.items()
    }
    clock: Any = SimpleNamespace(now_ns=0)
    line: Any = SimpleNamespace(nodes=nodes)
    meter = LineMeter(line, clock)
    for at_ms, name, state, code in (
        (1, "X", AlState.PREOP, 0), (2, "X", AlState.SAFEOP, 0), (3, "X", AlState.OP, 0),
        (4, "Y", AlState.OP, 0), (5, "X", AlState.OP, 0), (6, "X", AlState.SAFEOP, 0),
        (7, "X", AlState.SAFEOP, 0x1B), (8, "X", AlState.OP, 0), (9, "Y", AlState.INIT, 0x1B),
    ):  # fmt: skip
        clock.now_ns = at_ms * MS
        for observer in observers[name]:
            observer(state, code)
    found = [(one.time_ns // MS, one.port, one.is_active) for one in meter.changes]
    assert found == [(6, "X", False), (7, "X", False), (8, "X", True), (9, "Y", False)]
    words = [one.state for one in meter.changes]
    assert words[0] == words[1].partition(",")[0]
    assert "," not in words[0]
    assert words[2] == "OP"


def test_each_drive_of_cia_402_has_its_way_and_every_limit_that_was_corrected_is_a_warning(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of three drives the middle one is of another kind: #DRIVE has no objects of it."""

    class Drive(SimpleNamespace):
        """One of CiA 402."""

    monkeypatch.setattr(cia402, "Cia402Drive", Drive)
    monkeypatch.setattr(cia402, "DriveAccess", lambda *words: words)
    monkeypatch.setattr(
        cia402, "read_functions", lambda axis, given: (f"functions of {axis}", [axis, given])
    )
    part = part_of(can.CanBuses, {})
    part._bench.settings.axis = {name: f"list of {name}" for name in "XYZ"}
    part._accesses, part._warnings = {}, []
    x, y, z = Drive(sdo="x"), SimpleNamespace(sdo="y"), Drive(sdo="z")
    part.links = {"X": x, "Y": y, "Z": z}
    part._open_ways()
    assert part.warnings == ["X", "list of X", "Z", "list of Z"]
    assert part.accesses == {
        "X": (x, "x", "functions of X"), "Z": (z, "z", "functions of Z")
    }  # fmt: skip


@pytest.mark.parametrize(
    ("state", "is_off"),
    [(state, state in (State.SWITCH_ON_DISABLED, State.READY_TO_SWITCH_ON, State.FAULT))
     for state in State],
)  # fmt: skip
def test_a_drive_of_cia_402_has_left_operation_in_three_states(
    monkeypatch: pytest.MonkeyPatch, state: State, is_off: bool
) -> None:
    """Without voltage at the motor (CiA 402, state machine); another drive says it by its power."""
    monkeypatch.setattr(cia402, "Cia402Drive", Outside)
    part = part_of(can.CanBuses, {})
    part.links = {"X": Outside(state=state, power=None), "Y": SimpleNamespace(power=None)}
    assert part.is_off("X") is is_off
    for power in Power:
        part.links["Y"].power = power
        assert part.is_off("Y") is (power in (Power.OFF, Power.FAULT))
