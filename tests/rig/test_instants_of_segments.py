"""Instants of a cycle on paper, at their bounds: lines, cyclic segments, answers on CAN."""

from fractions import Fraction
from pathlib import Path

import pytest

from axisrig.bench.oracles.phases import Phases
from axisrig.bench.rig import contents
from axisrig.bench.rig.canopen.answers import first_answer_ns
from axisrig.bench.rig.cyclic.family import FAMILY as CYCLIC
from axisrig.bench.rig.cyclic.members import instants_of
from axisrig.bench.rig.cyclic.members import phases_of as cyclic_phases
from axisrig.bench.rig.ethercat.family import FAMILY as LINES
from axisrig.bench.rig.ethercat.keys import SegmentTable
from axisrig.bench.rig.ethercat.schedule import (
    CycleArithmetic,
    line_delays,
    overloads,
    schedule_of,
)
from axisrig.bench.rig.ethercat.timing import phases_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def settings_of(rig: str, *changes: str) -> Settings:
    return contents.settings_of(RIGS / rig, changes)


# --- a frame of a line


def arithmetic(**changes: int) -> CycleArithmetic:
    """A frame of 500 bytes, which has the wire (500 + 24) x 80 ns = 41.92 us; back after 100 us."""
    size = changes.pop("size", 500)
    given = {"image_bytes": 400, "period_ns": MS, "offset_ns": 600 * US, "frame_ns": 0,
             "there_ns": 60 * US, "back_ns": 100 * US, "mailbox_ns": 20 * US} | changes  # fmt: skip
    return CycleArithmetic([("head", 100), ("image", size - 100)], **given)


@pytest.mark.parametrize(
    ("size", "image_bytes", "fits"),
    [(1514, 400, True), (1515, 400, False), (1514, 1486, True), (1000, 1487, False)],
)
def test_a_frame_of_ethernet_has_1514_bytes_and_a_datagram_1486(
    size: int, image_bytes: int, fits: bool
) -> None:
    cycle = arithmetic(size=size, image_bytes=image_bytes, back_ns=300 * US)
    assert (cycle.fits_frame, cycle.fits, cycle.frame_bytes) == (fits, fits, size)


@pytest.mark.parametrize(
    ("frame_us", "back_us", "in_time"),
    [
        (0, 600, True), (0, 601, False), (599, 1, True), (599, 2, False),
        # It leaves after the NC cycle: the next one, 1600 us after the begin, reads it
        (600, 1000, True), (600, 1001, False), (900, 700, True), (900, 701, False),
    ],
)  # fmt: skip
def test_a_frame_is_back_before_the_nc_cycle_that_reads_it(
    frame_us: int, back_us: int, in_time: bool
) -> None:
    cycle = arithmetic(frame_ns=frame_us * US, back_ns=back_us * US, mailbox_ns=0, period_ns=2 * MS)
    early = arithmetic(frame_ns=frame_us * US, back_ns=back_us * US)
    assert early.is_before_cycle is (frame_us < 600)
    assert early.is_back_in_time is in_time
    assert cycle.is_before_cycle is early.is_before_cycle


@pytest.mark.parametrize(
    ("back_us", "mailbox_us", "fits"),
    [(500, 500, True), (500, 501, False), (10, 958, True), (10, 959, False)],
)
def test_a_cycle_has_room_for_one_mailbox_frame(back_us: int, mailbox_us: int, fits: bool) -> None:
    """Behind the frame that is back, or has left the wire after 41.92 us, whichever is later."""
    assert arithmetic(back_ns=back_us * US, mailbox_ns=mailbox_us * US).fits is fits


def test_a_wire_is_passed_twice_and_the_last_slave_once() -> None:
    """Wires of 10, 20, 40 ns before slaves of 100, 200, 400 ns."""
    settings = settings_of(
        "probe-xyz-ethercat.toml",
        "bus:ec1.wire_ns=X=10 Y=20 Z=40",
        "bus:ec1.slave_ns=X=100 Y=200 Z=400",
    )
    there_ns, back_ns = line_delays(settings, "ec1")
    assert there_ns == 10 + 20 + 40 + 100 + 200
    assert back_ns == 2 * (10 + 20 + 40) + 2 * (100 + 200) + 400


@pytest.mark.parametrize(
    ("change", "names"),
    [
        ("bus:ec1.dc=true", ["FPWR", "FRMW", "LRW", "BRD"]),
        ("bus:ec1.dc=false", ["LRW", "BRD"]),
        ("bus:ec1.drift_compensation=false", ["LRW", "BRD"]),
    ],
)
def test_time_is_in_the_frame_where_clocks_are_led(change: str, names: list[str]) -> None:
    parts = schedule_of(settings_of("probe-z-ethercat.toml", change), "ec1").parts
    assert [name.rpartition("(")[2].rstrip(")") for name, _ in parts[1:]] == names
    if change != "bus:ec1.dc=false":  # a terminal on the line needs its clocks
        watched = schedule_of(settings_of("plc-timestamp-line.toml", change), "ec1").parts
        last = "differences of clocks (BRD)" if "FPWR" in names else "states (BRD)"
        assert watched[-1][0] == last
        assert len(watched) == len(names) + 1 + ("FPWR" in names)


def test_a_terminal_on_the_line_is_in_the_image_and_its_clock_is_watched() -> None:
    """34 bytes of its registers more, and a datagram of 12 + 4 bytes for the differences."""
    cycle = schedule_of(settings_of("plc-timestamp-line.toml"), "ec1")
    alone = schedule_of(settings_of("probe-z-ethercat.toml"), "ec1")
    assert cycle.image_bytes == alone.image_bytes + 34
    assert cycle.frame_bytes == alone.frame_bytes + 34 + 16
    assert any(name == "process image of 2 (LRW)" for name, _ in cycle.parts)


def test_a_line_that_does_not_fit_is_named_with_its_times() -> None:
    """A wire of 296 us each way: back after 592 + 0.3 + 9.04 us, and 600 are allowed."""
    settings = settings_of(
        "probe-z-ethercat.toml", "bus:ec1.wire_ns=296000", "bus:ec1.overload=run"
    )
    assert overloads(settings) == {"ec1": "frame 101 bytes, back at 601.3 us"}
    later = settings_of(
        "probe-z-ethercat.toml", "bus:ec1.wire_ns=296000", "bus:ec1.overload=run",
        "bus:ec1.frame_us=200",
    )  # fmt: skip
    assert overloads(later) == {"ec1": "frame 101 bytes, back at 801.3 us"}  # of the cycle
    assert overloads(settings_of("probe-z-ethercat.toml")) == {}


def table(**keys: object) -> SegmentTable:
    return SegmentTable.model_validate({"carrier": "ethercat", **keys})


def test_a_key_of_a_line_is_one_number_or_one_for_each_slave() -> None:
    """Who is not named has the usual value; assumed_sample_us that of sample_us."""
    one = table(wire_ns=30, drift_ppm={"X": -2.5}, sample_us={"X": 5.0, "Z": -7.0})
    assert [one.of("wire_ns", axis) for axis in "XZ"] == [30.0, 30.0]
    assert [one.of("drift_ppm", axis) for axis in "XZ"] == [-2.5, 0.0]
    assert [one.of("assumed_sample_us", axis) for axis in "XYZ"] == [5.0, 0.0, -7.0]
    other = table(sample_us=3.0, assumed_sample_us={"X": 9.0})
    assert [other.of("assumed_sample_us", axis) for axis in "XZ"] == [9.0, 3.0]
    assert table(frame_us=1.5, shift_us=2.25).frame_ns == 1500
    assert table(frame_us=1.5, shift_us=2.25).shift_ns == 2250


@pytest.mark.parametrize(
    ("cell", "value"),
    [("40", 40.0), ("X=100 Z=-20", {"X": 100.0, "Z": -20.0}), ("Z=1.5", {"Z": 1.5})],
)
def test_a_cell_gives_a_key_for_all_slaves_or_by_axis(cell: str, value: object) -> None:
    assert table(drift_ppm=cell).drift_ppm == value


@pytest.mark.parametrize(
    ("cell", "is_on"), [("true", True), ("0", False), ("false", False), (1, True)]
)
def test_a_cell_switches_clocks(cell: object, is_on: bool) -> None:
    assert table(dc=cell).dc is is_on


# --- phases


def test_the_phases_of_an_axis_on_a_line() -> None:
    """SYNC0 at 250 us, positions 30 us before it; frame at 40 us, in the slave 9.09 us later."""
    changes = ("bus:ec1.shift_us=250", "bus:ec1.frame_us=40", "bus:ec1.sample_us=-30")
    found = phases_of(settings_of("probe-z-ethercat.toml", *changes), "Z")
    assert (found.period_ns, found.cycle_ns) == (MS, 600 * US)
    assert (found.frame_ns, found.sync_ns, found.sample_ns) == (40 * US, 250 * US, 220 * US)
    assert (found.passing_ns, found.back_ns) == (50 + 9_040, 2 * 50 + 300 + 9_040)
    # Without clocks the outputs are SYNC0
    plain = phases_of(settings_of("probe-z-ethercat.toml", *changes, "bus:ec1.dc=false"), "Z")
    passed_ns = 40 * US + plain.passing_ns
    assert (plain.sync_ns, plain.sample_ns) == (passed_ns, passed_ns)


def test_the_phases_of_a_cyclic_segment() -> None:
    """T_I 125 us before a cycle, images swapped at 200 us, set values taken at 300 us."""
    changes = ("bus:bus.input_us=125", "bus:bus.bus_us=200", "bus:bus.output_us=300",
               "bus:bus.request_us=5000")  # fmt: skip
    settings = settings_of("probe-z-profidrive.toml", *changes)
    at = instants_of(settings, "bus")
    assert (at.period_ns, at.input_ns, at.bus_ns, at.output_ns, at.request_ns) == (
        MS, 125 * US, 200 * US, 300 * US, 5 * MS,
    )  # fmt: skip
    found = cyclic_phases(settings, "Z")
    assert (found.frame_ns, found.sync_ns, found.sample_ns) == (0, 300 * US, 875 * US)
    assert (found.passing_ns, found.back_ns, found.cycle_ns) == (200 * US, 200 * US, 600 * US)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        (("input_us=799", "bus_us=200", "output_us=200"), None),
        (("input_us=800", "bus_us=200", "output_us=200"), "input_us"),
        (("bus_us=600", "output_us=600"), None),
        (("bus_us=601", "output_us=601"), "bus_us"),
        (("output_us=999",), None),
        (("output_us=1000",), "output_us"),
        (("bus_us=300", "output_us=300"), None),
        (("bus_us=300", "output_us=299"), "output_us"),
    ],
)
def test_an_instant_that_comes_before_what_it_needs_is_refused(
    changes: tuple[str, ...], key: str | None
) -> None:
    """The period is 1000 us, the NC cycle at 600 us."""
    kv = "set:Z.getriebe[0].kv=100"
    settings = settings_of("probe-z-profidrive.toml", kv, *(f"bus:bus.{one}" for one in changes))
    if key is None:
        CYCLIC.check(settings)
        return
    with pytest.raises(UserError) as caught:
        CYCLIC.check(settings)
    assert caught.value.message.startswith("segment bus: ")
    assert float(str(caught.value.value)) == float(dict(one.split("=") for one in changes)[key])


def test_a_line_says_when_its_values_act() -> None:
    """Frame, SYNC0 and sampling with their instants; one frame for both ways is a cycle later."""
    changes = ("bus:ec1.frame_us=10", "bus:ec1.shift_us=150", "bus:ec1.sample_us=-20")
    shown = LINES.describe(settings_of("probe-z-ethercat.toml", *changes))
    at = shown.index(
        "axis Z: frame at 10 us, SYNC0 at 150 us, positions sampled at 130 us of the cycle"
    )
    phases = Phases(MS, 600 * US, 10 * US, 150 * US, 130 * US, 9_090, 9_440)
    more = phases.way - 2
    assert more > 0
    assert shown[at + 1].startswith(f"  what an NC cycle sends is seen {2 + more} cycles later")


@pytest.mark.parametrize(
    ("shift_us", "sample_us", "at_us"),
    [(20, -30, 990), (20, -20, 0), (980, 20, 0), (980, 19.5, 999.5), (980, 60, 40)],
)
def test_a_sample_of_a_line_is_within_the_cycle(
    shift_us: float, sample_us: float, at_us: float
) -> None:
    changes = (f"bus:ec1.shift_us={shift_us}", f"bus:ec1.sample_us={sample_us}")
    settings = settings_of("probe-z-ethercat.toml", *changes)
    assert phases_of(settings, "Z").sample_ns == at_us * US
    words = f"SYNC0 at {shift_us:g} us, positions sampled at {at_us:g} us of the cycle"
    assert any(line.endswith(words) for line in LINES.describe(settings))


@pytest.mark.parametrize(("input_us", "at_us"), [(0, 0), (1, 999), (799, 201)])
def test_a_sample_of_a_cyclic_segment_is_within_the_cycle(input_us: int, at_us: int) -> None:
    changes = (f"bus:bus.input_us={input_us}", "bus:bus.bus_us=200", "bus:bus.output_us=300")
    found = cyclic_phases(settings_of("probe-z-profidrive.toml", *changes), "Z")
    assert found.sample_ns == at_us * US


LATE = ("bus:ec1.frame_us=620", "bus:ec1.shift_us=650")


@pytest.mark.parametrize(
    ("changes", "later"),
    [
        # Sent at 620, acts at 650; sampled at 1010 by a frame of 1620 that is back before 2600 us
        ((*LATE, "bus:ec1.sample_us=-640"), "2 cycles later, as on CAN"),
        # Sampled at 1650 by the frame of 2620
        (LATE, "3 cycles later, 1 cycle more than on CAN"),
        # That is back 2 x 490 us later, after the NC cycle of 3600 us
        ((*LATE, "bus:ec1.wire_ns=490000", "bus:ec1.overload=run", "bus:ec1.sample_us=500"),
         "4 cycles later, 2 cycles more than on CAN"),
    ],
)  # fmt: skip
def test_a_line_says_by_how_many_cycles_it_is_later_than_can(
    changes: tuple[str, ...], later: str
) -> None:
    settings = settings_of("probe-z-ethercat.toml", *changes)
    assert f"  what an NC cycle sends is seen {later}" in LINES.describe(settings)


def test_without_clocks_the_outputs_are_named_as_what_set_values_wait_for() -> None:
    """A frame of 101 - 2 x 16 bytes has passed after (69 + 12) x 80 ns, and a wire of 50 ns."""
    changes = ("bus:ec1.frame_us=10", "bus:ec1.dc=false")
    shown = LINES.describe(settings_of("probe-z-ethercat.toml", *changes))
    words = "axis Z: frame at 10 us, the outputs at 16.53 us, positions sampled at 16.53 us"
    assert any(line.startswith(words) for line in shown)


# --- answers on CAN


@pytest.mark.parametrize(
    ("rig", "bytes_of_data", "bits"),
    [
        ("probe-z.toml", 0, 44 + 3 + 44),
        ("probe-z.toml", 8, 44 + 3 + 44 + 64),
        ("distance-z-500k.toml", 4, 44 + 3 + 44 + 32),
    ],
)
def test_an_answer_ends_after_the_sync_and_itself_without_a_stuff_bit(
    rig: str, bytes_of_data: int, bits: int
) -> None:
    settings = settings_of(rig)
    (segment, keys), *_ = settings.segment.items()
    bit_ns = Fraction(10**9, keys.bitrate)  # type: ignore[attr-defined]
    assert first_answer_ns(settings, segment, bytes_of_data) == bits * bit_ns
