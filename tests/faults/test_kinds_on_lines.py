"""Each kind of fault of lines, images and drives with idents, from its cell to what it does."""

import random
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.ethercat.frame import datagrams
from axisrig.bench.machine.faults import idents, images, lines
from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.rig.reading.faults import read_faults
from axisrig.bench.rig.reading.file import read_rig
from axisrig.kernel.profiles.ethercat.tables import AlState, Command
from axisrig.kernel.time.clock import MS, US

pytestmark = pytest.mark.interpreted  # stand-ins for typed parts

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
KINDS = {**lines.KINDS, **images.KINDS, **idents.KINDS}


class Line:
    """A line, a cyclic segment and their drives that note what a fault asks of them."""

    def __init__(self, rig: str) -> None:
        self.rig, _ = read_rig(RIGS / rig)
        self.calls: list[tuple[Any, ...]] = []
        self.passing: list[Any] = []
        self.broken: dict[str, Any] = {}
        self.answers: dict[str, Any] = {}
        self.falls: dict[str, dict[str, list[Any]]] = {
            place: {axis: [] for axis in self.rig.axis} for place in ("lost", "missed", "late")
        }
        self.clock = SimpleNamespace(now_ns=7 * MS)
        self.on: Any = SimpleNamespace(
            clock=self.clock,
            line=SimpleNamespace(
                disturb=self.passing.append,
                breaks=lambda axis, falls: self.broken.update({axis: falls}),
                fall=lambda *words: self.calls.append(("fall", *words)),
                jump=lambda *words: self.calls.append(("jump", *words)),
            ),
            segment=SimpleNamespace(**self.falls),
            nodes={axis: self._drive(axis) for axis in self.rig.axis},
        )

    def _drive(self, axis: str) -> Any:
        def note(*words: Any, **named: Any) -> None:
            self.calls.append((axis, *words, *named.values()))

        return SimpleNamespace(
            hold_bit=note,
            interrupt_probing=lambda: note("interrupted"),
            disturb_channel=lambda answers: self.answers.update({axis: answers}),
            encoder=SimpleNamespace(break_off=note),
        )

    def do(self, kind: str, cell: str) -> tuple[Act, Injected]:
        (fault,) = read_faults(kind, cell, self.rig)
        record = Injected(kind, fault.axis)
        return KINDS[kind](self.on, fault, random.Random(1), record), record


def test_a_line_that_is_late_or_loses_frames_does_so_in_its_window_alone() -> None:
    """Frames of a line are counted from 0 hits on; None = lost, ns = how much later it goes."""
    line = Line("probe-z-ethercat.toml")
    for kind, keys, low, high in (
        ("line_lost", "", None, None),
        ("line_late", "by=300us", 300 * US, 300 * US),
        ("line_late", "by=300us jitter=100us", 300 * US, 400 * US),
    ):
        act, record = line.do(kind, f"ec1 {keys}")
        passing = line.passing.pop()
        assert (passing(bytearray()), record.hits) == (0, 0)
        act.begin()
        found = [passing(bytearray()) for _ in range(50)]
        assert (record.hits, record.last_hit_ns) == (50, 7 * MS)
        if low is None:
            assert found == [None] * 50
        else:
            assert low <= min(found) <= max(found) <= high
            assert (len({*found}) > 1) == (low != high)
        act.end()
        assert (passing(bytearray()), record.hits) == (0, 50)


def test_no_slave_acts_on_an_image_that_is_unanswered() -> None:
    """ETG.1000.4: a datagram is 10 bytes, its data, 2 of counter; NOP is 0, LRW 12, LRD 10."""
    heads = [(Command.LRD, 4), (Command.LRW, 6), (Command.LRW, 2)]
    frame = bytearray(bytes(12) + b"\x88\xa4" + bytes(2))
    for number, (command, size) in enumerate(heads):
        more = 0x8000 if number < len(heads) - 1 else 0
        frame += bytes((command, number, *(4 * (0,)))) + (size | more).to_bytes(2, "little")
        frame += bytes(2 + size + 2)
    frame[14:16] = (len(frame) - 16 | 0x1000).to_bytes(2, "little")
    before = [(each.command, each.start) for each in datagrams(frame)]
    assert [command for command, _ in before] == [command for command, _ in heads]
    line = Line("probe-z-ethercat.toml")
    act, _ = line.do("line_unanswered", "ec1")
    (passing,) = line.passing
    assert passing(frame) == 0
    assert [each.command for each in datagrams(frame)] == [command for command, _ in heads]
    act.begin()
    assert passing(frame) == 0
    assert [each.command for each in datagrams(frame)] == [Command.LRD, Command.NOP, Command.NOP]


def test_frames_break_before_the_slave_of_the_named_axis() -> None:
    line = Line("probe-xyz-ethercat.toml")
    act, record = line.do("line_corrupt", "Y skip=1 count=2")
    assert [*line.broken] == ["Y"]
    falls = line.broken["Y"]
    assert not falls()
    act.begin()
    assert [falls() for _ in range(5)] == [False, True, True, False, False]
    assert (record.hits, record.last_hit_ns) == (2, 7 * MS)


def test_a_slave_falls_and_its_clock_jumps_once() -> None:
    line = Line("probe-xyz-ethercat.toml")
    code = read_faults("slave_falls", "Z", line.rig)[0].values["code"]
    for kind, cell in (
        ("slave_falls", "Z"), ("slave_falls", "X state=INIT"), ("clock_jump", "Y by=5us"),
    ):  # fmt: skip
        act, _ = line.do(kind, cell)
        act.begin()
        act.end()
    assert line.calls == [
        ("fall", "Z", AlState.SAFEOP, code),
        ("fall", "X", AlState.INIT, code),
        ("jump", "Y", 5 * US),
    ]


@pytest.mark.parametrize("first", [Command.LRW, Command.LRD, Command.LWR])
def test_an_image_is_unanswered_wherever_it_is_in_its_frame(first: Command) -> None:
    """The first datagram of a frame has number 0."""
    frame = bytearray(bytes(12) + b"\x88\xa4" + bytes(2))
    for number, command in enumerate((first, Command.LRW)):
        more = 0 if number else 0x8000
        frame += bytes((command, number, *(4 * (0,)))) + (4 | more).to_bytes(2, "little")
        frame += bytes(2 + 4 + 2)
    frame[14:16] = (len(frame) - 16 | 0x1000).to_bytes(2, "little")
    line = Line("probe-z-ethercat.toml")
    act, _ = line.do("line_unanswered", "ec1")
    act.begin()
    (passing,) = line.passing
    assert passing(frame) == 0
    left = Command.NOP if first is Command.LRW else first
    assert [each.command for each in datagrams(frame)] == [left, Command.NOP]


@pytest.mark.parametrize(("level", "passed"), [(0, False), (1, True)])
def test_a_bit_keeps_its_level_and_passes_again(level: int, passed: bool) -> None:
    line = Line("probe-z-sercos.toml")
    name = read_faults("bit_stuck", "Z", line.rig)[0].values["real_time"]
    act, _ = line.do("bit_stuck", f"Z level={level}")
    act.begin()
    act.end()
    assert line.calls == [("Z", name, passed), ("Z", name, None)]


def test_a_service_channel_is_silent_or_refuses_and_answers_again() -> None:
    line = Line("probe-z-sercos.toml")
    code = read_faults("soe_refused", "Z", line.rig)[0].values["soe"]
    assert code
    for kind, answer in (("soe_silent", ""), ("soe_refused", code)):
        act, record = line.do(kind, "Z count=2")
        answers = line.answers.pop("Z")
        assert answers() is None
        act.begin()
        assert [answers() for _ in range(4)] == [answer, answer, None, None]
        assert (record.hits, record.last_hit_ns) == (2, 7 * MS)
        act.end()
        assert answers() is None


def test_a_probing_cycle_ends_by_itself_once() -> None:
    line = Line("probe-z-sercos.toml")
    act, record = line.do("command_ends", "Z")
    assert not line.calls
    act.begin()
    act.end()
    assert (line.calls, record.hits) == ([("Z", "interrupted")], None)


@pytest.mark.parametrize(
    ("keys", "hit"),
    [
        ({"p": 1.0, "skip": 0, "count": None}, [3, 4, 5, 6]),
        ({"p": 1.0, "skip": 2, "count": None}, [5, 6]),
        ({"p": 1.0, "skip": 1, "count": 2}, [4, 5]),
        ({"p": 0.0, "skip": 0, "count": None}, []),
    ],
)
@pytest.mark.parametrize("place", ["lost", "missed", "late"])
def test_images_that_are_hit_are_counted_and_no_others(
    place: str, keys: dict[str, Any], hit: Sequence[int]
) -> None:
    """Ten images, one each ms; the fault acts from the third to the sixth, and of Z alone."""
    clock: Any = SimpleNamespace(now_ns=0)
    asked: dict[str, dict[str, list[Any]]] = {
        name: {"X": [], "Z": []} for name in ("lost", "missed", "late")
    }
    on: Any = SimpleNamespace(clock=clock, segment=SimpleNamespace(**asked))
    fault: Any = SimpleNamespace(axis="Z", values=keys)
    record = Injected(f"image_{place}", "Z")
    act = KINDS[f"image_{place}"](on, fault, random.Random(1), record)
    (falls,) = asked[place]["Z"]
    assert sum(len(found) for of_axis in asked.values() for found in of_axis.values()) == 1
    fallen = []
    for number in range(1, 11):
        if number == 3:
            act.begin()
        if number == 7:
            act.end()
        clock.now_ns = number * MS
        if falls():
            fallen.append(number)
    assert fallen == hit
    assert (record.hits, record.last_hit_ns) == (len(hit), max(hit, default=0) * MS)


@pytest.mark.parametrize("place", ["lost", "missed", "late"])
def test_two_faults_of_the_images_of_one_drive_are_both_asked(place: str) -> None:
    """In the order in which they are built in; each counts its own hits."""
    line = Line("probe-z-profidrive.toml")
    cells = ("Z count=1", "Z skip=1")
    acts, records = zip(*[line.do(f"image_{place}", cell) for cell in cells], strict=True)
    asked = line.falls[place]["Z"]
    assert len(asked) == 2
    for act in acts:
        act.begin()
    assert [[falls() for falls in asked] for _ in range(3)] == [
        [True, False], [False, True], [False, True]
    ]  # fmt: skip
    assert [record.hits for record in records] == [1, 2]


def test_an_encoder_interface_breaks_off_with_the_code_of_its_cell() -> None:
    line = Line("probe-z-profidrive.toml")
    act, _ = line.do("encoder_error", "Z error=17")
    act.begin()
    act.end()
    assert line.calls == [("Z", 17)]
