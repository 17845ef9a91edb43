"""What each kind of fault does to the frames of one segment, without a machine.

A drive Z (node 3) sends a telegram at every whole ms: its number, 0x11, 0x22. What the kernel gets
of it is written out. A frame takes less than 0.2 ms at 1 Mbit/s.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.machine.faults.acts import Act, Injected
from axisrig.bench.machine.faults.frames import OnCan
from axisrig.bench.machine.faults.injection import ON_CAN, inject
from axisrig.bench.machine.faults.when import Moments, Watched
from axisrig.bench.rig.reading.faults import Fault, read_faults
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import read_settings
from axisrig.kernel.cosim.plant.probe import PlantSignal
from axisrig.kernel.time.clock import MS, Phase
from axisrig.kernel.time.scheduler import new_scheduler

RIG, FILES = read_rig(Path(__file__).parents[2] / "testplans" / "rigs" / "probe-z.toml")


class Drive:
    """A virtual drive with one probing input, whose rising edges are latched."""

    def __init__(self) -> None:
        self.latch_watches: list[Callable[[], None]] = []
        self.latches, self.is_enabled, self.is_stored = (self,), False, False

    def turn(self, name: str, value: bool) -> None:
        setattr(self, {"armed": "is_enabled", "latched": "is_stored"}[name], value)
        for watch in self.latch_watches:
            watch()

    def has_stored(self, is_rising: bool) -> bool:
        return is_rising and self.is_stored


class Wire:
    """The segment with a drive, a kernel and another drive; the program starts at 2.5 ms."""

    def __init__(self, *faults: tuple[str, str], seed: int = 1, can_id: int = 0x183,
                 data: bytes | None = None, edge: str = "POS") -> None:  # fmt: skip
        self.clock = new_scheduler()
        self.segment = Segment("can1", 1_000_000, self.clock)
        self.port = self.segment.port("Z")
        self.kernel, self.other = self.segment.port("kernel"), self.segment.port("X")
        self.got: list[tuple[float, int, str]] = []
        self.got_by_other: list[int] = []
        self.kernel.attach_data(self._take)
        self.other.attach_data(lambda can_id, _data, _time: self.got_by_other.append(can_id))
        self.power: list[tuple[str, float]] = []
        self.channel = SimpleNamespace(
            start_ns=None, interpolator=SimpleNamespace(is_standing=True), observers=[]
        )
        self.link = SimpleNamespace(probe_input=1, edge=edge, has_latched=False)
        self.drive = Drive()
        self.node = SimpleNamespace(
            power_off=lambda: self.power.append(("off", self.now_ms)),
            power_on=lambda: self.power.append(("on", self.now_ms)),
        )
        self.signal = PlantSignal(level=False)
        name = RIG.axis["Z"].probe_1
        found = [fault for kind, text in faults for fault in read_faults(kind, text, RIG)]
        settings = read_settings(RIG, FILES, [])
        settings.faults.extend(found)
        nodes: Any = {"Z": self.node}
        buses = OnCan(settings, self.clock, {"can1": self.segment}, nodes)
        plant = SimpleNamespace(probes={name: SimpleNamespace(signal=self.signal)})
        parts: Any = (self.channel, {"Z": self.link}, {"Z": self.drive}, plant)
        moments = Moments(Watched(RIG, self.clock, *parts))

        def build(fault: Fault, *rest: Any) -> Act:
            return ON_CAN[fault.kind](buses, fault, *rest)

        self.records: list[Injected] = inject(settings, moments, [], build, seed)
        self.port.attach_data(lambda _id, _data, _time: None)
        self.at(2.5, self.start)
        for number in range(1, 13):
            content = bytes([number, 0x11, 0x22]) if data is None else data
            self.at(number, lambda content=content: self.port.send_raw(can_id, content))

    @property
    def now_ms(self) -> float:
        return self.clock.now_ns / MS

    def start(self) -> None:
        self.channel.start_ns = self.clock.now_ns
        self.cycle()

    def cycle(self) -> None:
        """End an NC cycle."""
        for observer in self.channel.observers:
            observer(self.channel)

    def at(self, time_ms: float, what: Callable[[], None]) -> None:
        self.clock.call_at(round(time_ms * MS), Phase.APPLICATION, what)

    def _take(self, can_id: int, data: bytes, _time: float) -> None:
        self.got.append((self.now_ms, can_id, data.hex()))

    def run(self) -> "Wire":
        self.clock.run_until(20 * MS)
        return self

    def numbers(self) -> list[int]:
        return [int(data[:2], 16) for _, can_id, data in self.got if can_id == 0x183]


@pytest.fixture
def wire() -> Iterator[Callable[..., Wire]]:
    made: list[Wire] = []

    def make(*faults: tuple[str, str], **given: Any) -> Wire:
        if made:
            made.pop().segment.close()
        made.append(Wire(*faults, **given))
        return made[-1]

    yield make
    for each in made:
        each.segment.close()


ALL = list(range(1, 13))


@pytest.mark.parametrize(
    ("kind", "text", "numbers", "hits"),
    [
        ("drop", "Z.TPDO1", [], 12),
        ("drop", "Z.TPDO2", ALL, 0),
        ("drop", "Z.TPDO1 skip=3 count=2", [1, 2, 3, *range(6, 13)], 2),
        ("drop", "Z.TPDO1 p=0", ALL, 0),
        ("drop", "Z.TPDO1 for=3.5ms", range(4, 13), 3),
        # The program starts at 2.5 ms: 2.5 + 2.4 = 4.9, and 3 ms more are 7.9
        ("drop", "Z.TPDO1 at=2.4ms", [1, 2, 3, 4], 8),
        ("drop", "Z.TPDO1 at=2.6ms", [1, 2, 3, 4, 5], 7),
        ("drop", "Z.TPDO1 at=2.4ms for=3ms", [1, 2, 3, 4, 8, 9, 10, 11, 12], 3),
        ("drop", "Z.TPDO1 at=start count=1", [1, 2, *range(4, 13)], 1),
        ("swap", "Z.TPDO1 count=1", [2, 1, *range(3, 13)], 1),
        ("swap", "Z.TPDO1 skip=1 count=1", [1, 3, 2, *range(4, 13)], 1),
        ("duplicate", "Z.TPDO1 count=2", [1, 1, 2, 2, *range(3, 13)], 2),
        ("corrupt", "Z.TPDO1 bit=20 count=3", ALL, 3),
    ],
)
def test_which_telegrams_arrive(
    wire: Callable[..., Wire], kind: str, text: str, numbers: Any, hits: int
) -> None:
    ran = wire((kind, text)).run()
    assert ran.numbers() == [*numbers]
    (record,) = ran.records
    assert record.hits == hits
    assert record.begin_ns is not None
    begin_ms, target = record.begin_ns / MS, text.split(maxsplit=1)[0]
    words = f"fault {kind} {target}: from {begin_ms:g} ms, frames hit: {hits}"
    assert record.in_words() == words


@pytest.mark.parametrize(
    ("kind", "text", "can_id", "late_ms"),
    [
        ("delay", "Z.TPDO1 by=300us", 0x183, (0.3, 0.3)),
        ("delay", "Z.TPDO1 by=300us jitter=100us", 0x183, (0.3, 0.4)),
        ("delay", "Z.TPDO1 by=2us jitter=0us", 0x183, (0.002, 0.002)),
        ("sync_jitter", "can1 jitter=400us", 0x080, (0.0, 0.4)),
        ("slow_sdo", "Z by=500us", 0x583, (0.5, 0.5)),
        ("slow_sdo", "Z by=500us jitter=50us", 0x583, (0.5, 0.55)),
    ],
)
def test_how_late_telegrams_arrive(
    wire: Callable[..., Wire], kind: str, text: str, can_id: int, late_ms: tuple[float, float]
) -> None:
    plain = [time_ms for time_ms, *_ in wire(can_id=can_id).run().got]
    late = [time_ms for time_ms, *_ in wire((kind, text), can_id=can_id).run().got]
    waits = [round(b - a, 6) for a, b in zip(plain, late, strict=True)]
    assert late_ms[0] <= min(waits) <= max(waits) <= late_ms[1]
    assert (len(set(waits)) > 6) == (late_ms[0] != late_ms[1])


@pytest.mark.parametrize(
    ("text", "data"),
    [
        ("byte=2 xor=0x81", "019022"),
        ("byte=1 xor=255", "fe1122"),
        ("byte=8 xor=1", "011123"),  # after the end: the last one
        ("byte=3 xor=0x10", "011132"),
    ],
)
def test_bits_of_a_byte_are_turned(wire: Callable[..., Wire], text: str, data: str) -> None:
    assert wire(("alter", f"Z.TPDO1 count=1 {text}")).run().got[0][2] == data


def test_without_a_place_one_bit_somewhere_is_turned(wire: Callable[..., Wire]) -> None:
    """Every byte and every bit of one comes up in 480 telegrams."""
    changes = [
        int(data, 16) ^ (number << 16 | 0x1122)
        for seed in range(40)
        for number, (_, _, data) in enumerate(wire(("alter", "Z.TPDO1"), seed=seed).run().got, 1)
    ]
    assert len(changes) == 480
    assert {*changes} == {1 << bit for bit in range(24)}
    assert wire(("alter", "Z.TPDO1"), data=b"").run().got == []  # no data: lost


@pytest.mark.parametrize(("text", "after_ms"), [("", 0.0), ("after=250us", 0.25)])
def test_a_second_frame_comes_after_the_end_of_the_first(
    wire: Callable[..., Wire], text: str, after_ms: float
) -> None:
    first, second = wire(("duplicate", f"Z.TPDO1 count=1 {text}")).run().got[:2]
    # Intermission of 3 bits at least, then 71 bits with 3 bytes and at most 16 stuff bits
    begin_ms = max(after_ms, 0.003)
    assert begin_ms + 0.071 <= round(second[0] - first[0], 6) <= begin_ms + 0.087
    assert first[2] == second[2]


def test_a_destroyed_frame_is_sent_again(wire: Callable[..., Wire]) -> None:
    """20 bits, error flag and delimiter, intermission: 0.03 to 0.05 ms for each attempt."""
    plain = wire().run().got[0][0]
    late = wire(("corrupt", "Z.TPDO1 bit=20 count=2")).run().got[0][0]
    assert 0.06 <= late - plain <= 0.1


@pytest.mark.parametrize(
    ("kind", "target", "can_id", "is_got", "is_got_by_other"),
    [
        ("sync_loss", "can1", 0x080, False, False),
        ("heartbeat_loss", "Z", 0x703, False, False),
        ("drop", "Z.EMCY", 0x083, False, False),
        ("drop", "Z.SDO", 0x583, False, False),
        ("drop", "Z.HEARTBEAT", 0x703, False, False),
        ("drop", "Z.TPDO3", 0x383, False, False),
        ("drop", "Z.RPDO4", 0x503, False, False),
        ("drop", "can1.NMT", 0x000, False, False),
        ("drop", "can1.SYNC", 0x081, True, True),
        ("heartbeat_loss", "Z", 0x704, True, True),
    ],
)
def test_whose_frames_are_lost(
    wire: Callable[..., Wire], kind: str, target: str, can_id: int, is_got: bool,
    is_got_by_other: bool,
) -> None:  # fmt: skip
    ran = wire((kind, target), can_id=can_id).run()
    assert (bool(ran.got), bool(ran.got_by_other)) == (is_got, is_got_by_other)


def test_a_sync_that_one_drive_misses(wire: Callable[..., Wire]) -> None:
    """The drive is the port with the name of its axis; all others get it."""
    ran = wire(("sync_loss", "Z"))
    heard: list[int] = []
    ran.port.attach_data(lambda can_id, _data, _time: heard.append(can_id))
    ran.at(0.5, lambda: ran.kernel.send_raw(0x080, b""))
    ran.at(0.7, lambda: ran.kernel.send_raw(0x203, b"\1"))
    ran.run()
    assert heard == [0x203]
    assert ran.got_by_other[:2] == [0x080, 0x203]


def test_a_node_that_babbles(wire: Callable[..., Wire]) -> None:
    """From 2.5 + 1.6 ms for 2 ms, one frame each 500 us, as the period counts from 0 on."""
    ran = wire(("babble", "can1 id=0x5 bytes=2 period=500us at=1.6ms for=2ms")).run()
    times = [time_ms for time_ms, can_id, _ in ran.got if can_id == 5]
    assert [int(time_ms * 2) / 2 for time_ms in times] == [4.5, 5.0, 5.5, 6.0]
    assert {data for _, can_id, data in ran.got if can_id == 5} == {"0000"}
    (record,) = ran.records
    assert record.hits is None
    begin_ns, end_ns = record.begin_ns, record.end_ns
    assert begin_ns is not None
    assert end_ns == begin_ns + 2 * MS
    assert record.marks() == [(begin_ns, "babble can1 begins"), (end_ns, "babble can1 ends")]


@pytest.mark.parametrize(
    ("text", "sent"),
    [
        ("data=ff00", ["ff00"] * 11),
        ("data=last", [f"{n:02x}1122" for n in range(1, 12)]),
        ("", [f"{n:02x}1122" for n in range(1, 12)]),
        ("skip=2 count=3 data=aa", ["aa"] * 3),
        ("p=0", []),
    ],
)
def test_a_second_sender_of_a_telegram(
    wire: Callable[..., Wire], text: str, sent: list[str]
) -> None:
    """After each frame but the first, when it knows none yet."""
    got = [data for *_, data in wire(("second_sender", f"Z.TPDO1 {text}")).run().got]
    real = [f"{n:02x}1122" for n in ALL]
    extra = list(got)
    for data in real:
        extra.remove(data)
    assert extra == sent


def test_a_second_sender_waits_and_draws_its_bytes(wire: Callable[..., Wire]) -> None:
    ran = wire(("second_sender", "Z.TPDO1 after=300us data=random")).run()
    second, third = ran.got[1], ran.got[2]
    assert second[2] == "021122"
    assert 0.3 <= third[0] - second[0] <= 0.45
    assert len(third[2]) == 6
    assert third[2] not in ("011122", "021122")


@pytest.mark.parametrize(
    ("command", "number"),
    [("", 129), ("command=reset", 129), ("command=reset_communication", 130),
     ("command=stop", 2), ("command=pre_operational", 128)],
)  # fmt: skip
def test_a_command_that_the_kernel_did_not_send(
    wire: Callable[..., Wire], command: str, number: int
) -> None:
    """CiA 301, NMT: command, then the node."""
    ran = wire(("reset", f"Z at=start {command}")).run()
    ((time_ms, _, data),) = [each for each in ran.got if each[1] == 0]
    assert bytes.fromhex(data) == bytes([number, 3])
    assert 2.5 < time_ms < 2.6  # a frame of two bytes takes less than 0.1 ms


def test_a_drive_without_power_comes_back(wire: Callable[..., Wire]) -> None:
    assert wire(("power_loss", "Z at=1.5ms for=4ms")).run().power == [("off", 4.0), ("on", 8.0)]
    ran = wire(("power_loss", "Z")).run()  # 100 ms by default
    assert ran.power == [("off", 0.0)]


def test_a_controller_off_the_bus(wire: Callable[..., Wire]) -> None:
    """With a time it is gone for that long, without one it recovers: 128 times 11 bits, 1.4 ms."""
    assert wire(("bus_off", "Z at=2ms for=4ms")).run().numbers() == [1, 2, 3, 4, *range(9, 13)]
    ran = wire(("bus_off", "Z at=2ms")).run()
    assert ran.numbers() == [1, 2, 3, 4, *range(6, 13)]
    assert ran.port.error_state is ErrorState.ACTIVE


def test_a_drive_whose_plug_is_pulled_stays_on(wire: Callable[..., Wire]) -> None:
    """It misses what is sent meanwhile, is on all the time, and hears again without a boot-up."""
    ran = wire(("cable_off", "Z at=2ms for=4ms")).run()
    assert (ran.numbers(), ran.power) == ([1, 2, 3, 4, *range(9, 13)], [])
    assert ran.port.error_state is ErrorState.ACTIVE
    gone = wire(("cable_off", "Z at=2ms")).run()
    assert (gone.numbers(), gone.power) == ([1, 2, 3, 4], [])
    assert wire(("cable_off", "Z at=2ms for=1us")).run().numbers() == [*range(1, 13)]


def rises(ran: Wire, name: str, value: Any) -> None:
    """Bring the condition of a moment about, or end it."""
    if name in ("motion", "standing"):
        ran.channel.interpolator.is_standing = (name == "standing") is value
        ran.cycle()
    elif name in ("armed", "latched"):
        ran.drive.turn(name, value)
    elif name == "edge":
        ran.signal.add(ran.clock.now_ns, value)
    else:
        ran.link.has_latched = value
        ran.cycle()


@pytest.mark.parametrize("name", ["motion", "standing", "armed", "edge", "latched", "seen"])
@pytest.mark.parametrize(("nth", "first"), [(1, 5), (2, 9), (3, None)])
def test_a_moment_is_when_its_condition_begins_the_nth_time(
    wire: Callable[..., Wire], name: str, nth: int, first: int | None
) -> None:
    """On from 4.5 to 6.5 ms and again from 8.5; before the program starts it does not count."""
    ran = wire(("drop", f"Z.TPDO1 at={name} nth={nth}"))
    rises(ran, name, False)
    for time_ms, value in ((0.5, True), (1.5, False), (4.5, True), (6.5, False), (8.5, True)):
        ran.at(time_ms, lambda value=value: rises(ran, name, value))
    ran.run()
    assert ran.numbers() == (ALL if first is None else list(range(1, first)))
    if first is None:
        assert ran.records[0].marks() == []
        assert ran.records[0].in_words() == "fault drop Z.TPDO1: its moment has not come"


@pytest.mark.parametrize(("edge", "first"), [("POS", 5), ("NEG", 7)])
def test_the_edge_is_the_one_that_the_axis_waits_for(
    wire: Callable[..., Wire], edge: str, first: int
) -> None:
    ran = wire(("drop", "Z.TPDO1 at=edge"), edge=edge)
    for time_ms, level in ((2.7, edge == "NEG"), (4.5, True), (6.5, False)):
        ran.at(time_ms, lambda level=level: ran.signal.add(ran.clock.now_ns, level))
    ran.run()
    assert ran.numbers() == list(range(1, first))


@pytest.mark.parametrize(
    ("offset", "begin_ms"), [("", 4.5), ("+0.2ms", 4.5), ("+0.5ms", 4.6), ("+3ms", 7.1)]
)
def test_an_offset_counts_from_the_edge_itself(
    wire: Callable[..., Wire], offset: str, begin_ms: float
) -> None:
    """The plant is stepped at 4.5 ms over an edge at 4.1 ms: nothing can begin before 4.5 ms."""
    ran = wire(("drop", f"Z.TPDO1 at=edge{offset}"))
    ran.at(4.5, lambda: ran.signal.add(round(4.1 * MS), True))
    ran.run()
    assert ran.records[0].begin_ns == round(begin_ms * MS)


def test_a_further_fault_changes_nothing_about_the_others_and_a_seed_does(
    wire: Callable[..., Wire],
) -> None:
    half = ("drop", "Z.TPDO1 p=0.5")
    alone = wire(half).run().numbers()
    assert wire(half).run().numbers() == alone
    assert 2 < len(alone) < 10
    assert wire(
        half, ("delay", "Z.TPDO2 jitter=1ms"), ("drop", "Z.TPDO3 p=0.5")
    ).run().numbers() == (alone)
    assert wire(half, seed=2).run().numbers() != alone
    both = wire(half, half).run().numbers()
    assert set(both) < set(alone)  # two of a kind draw two sequences


def test_marks_of_a_fault_with_one_hit_and_with_several(wire: Callable[..., Wire]) -> None:
    for count, words in ((1, "1 frame hit"), (2, "2 frames hit, the last")):
        (record,) = wire(("drop", f"Z.TPDO1 count={count} for=9ms")).run().records
        assert [text for _, text in record.marks()] == [
            "drop Z.TPDO1 begins", f"drop Z.TPDO1: {words}", "drop Z.TPDO1 ends",
        ]  # fmt: skip
        assert [time_ns / MS for time_ns, _ in record.marks()] == [0, count, 9]


def test_a_frame_is_destroyed_at_its_bit_or_at_a_drawn_one(wire: Callable[..., Wire]) -> None:
    """At 1 Mbit/s the frame that is sent again comes so many us later; a bit is drawn from all."""

    def first_us(keys: str, seed: int = 1) -> float:
        run = wire(("corrupt", f"Z.TPDO1 count=1 {keys}"), seed=seed).run()
        return run.got[0][0] * 1000

    at = {bit: first_us(f"bit={bit}") for bit in (1, 2, 20, 60)}
    assert [at[bit] - at[1] for bit in at] == pytest.approx([0, 1, 19, 59])
    drawn = {round(first_us("", seed) - at[1]) for seed in range(20)}
    assert len(drawn) > 10
    assert 0 <= min(drawn) < 20  # of some 75 bits
    assert 40 < max(drawn) < 80
