"""The cycle of an EtherCAT line as a rig has it: what does not fit is refused, with the arithmetic.

The frame of one axis, by hand: 16 bytes of heads, two datagrams of 12 + 4 for the time, one of
12 + 27 for the image (8 out, 18 in, 1 of the mailbox), one of 12 + 2 for the states: 101. With 24
more at 80 ns it has the wire for 10 us; it is received whole after 8 + 101 + 4 bytes, 9.04 us.
"""

from pathlib import Path

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.ethercat.family import FAMILY
from axisrig.bench.rig.ethercat.members import (
    position_of,
    segment_of,
    slaves_on,
    terminal_on,
    terminal_position,
    watches_clocks,
)
from axisrig.bench.rig.ethercat.on_line import axis_pdos
from axisrig.bench.rig.ethercat.schedule import schedule_of
from axisrig.bench.rig.ethercat.startup import axis_steps
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.drives.canopen.startup_steps import Write
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def settings_of(*changes: str, rig: str = "probe-z-ethercat.toml") -> Settings:
    assigned = [(parse_assignment(text), as_written) for text in changes]
    return read_settings(*read_rig(RIGS / rig), assigned)


def test_the_cycle_of_one_axis() -> None:
    cycle = schedule_of(settings_of(), "ec1")
    assert (cycle.frame_bytes, cycle.wire_ns) == (101, 10_000)
    # A wire of 50 ns each way and a slave of 300 ns
    assert (cycle.there_ns, cycle.back_ns) == (50 + 9_040, 2 * 50 + 300 + 9_040)
    assert cycle.mailbox_ns == (16 + 12 + 128 + 24) * 80


def test_three_axes_share_the_frame() -> None:
    """27 bytes for each; wires before three slaves, two of them passed both ways."""
    settings = settings_of("bus:ec1.wire_ns=50", rig="probe-xyz-ethercat.toml")
    cycle = schedule_of(settings, "ec1")
    length = 16 + 2 * 16 + 12 + 3 * 27 + 14
    assert cycle.frame_bytes == length
    assert cycle.back_ns == 6 * 50 + 5 * 300 + (8 + length + 4) * 80


@pytest.mark.parametrize("has_inputs", [True, False])
@pytest.mark.parametrize("released", [True, False])
def test_the_image_has_inputs_of_the_drive_and_a_second_encoder_that_is_released(
    has_inputs: bool, released: bool
) -> None:
    """60FD where the drive has it, 60E4:1 where distance control wants it: neither decides the
    other. P-AXIS-00328 releases it."""
    changes = [f"set:Z.lr_param.distance_control_on={int(released)}"]
    changes += [] if has_inputs else ["drive:servo.lacks=60FD"]
    for rig, has_encoder in (("distance-z-ethercat.toml", True), ("probe-z-ethercat.toml", False)):
        _, inputs = axis_pdos(settings_of(*changes, rig=rig), "Z")
        places = [(mapped.index, mapped.sub) for mapped in inputs.objects]
        assert ((0x60FD, 0) in places) is has_inputs
        assert ((0x60E4, 1) in places) is (released and has_encoder)


LONGEST_NS = (600_000 - 300 - 9_040) // 2
"""Of the wire, each way, so that the frame is back at the NC cycle at 600 us."""


@pytest.mark.parametrize(("wire_ns", "fits"), [(LONGEST_NS, True), (LONGEST_NS + 1, False)])
def test_a_frame_that_is_back_after_its_nc_cycle_is_refused(wire_ns: int, fits: bool) -> None:
    settings = settings_of(f"bus:ec1.wire_ns={wire_ns}")
    if fits:
        FAMILY.check(settings)
        return
    with pytest.raises(UserError) as caught:
        FAMILY.check(settings)
    message = caught.value.message
    assert message.startswith("the cycle does not fit on segment ec1")
    assert "frame 101 bytes, at least 60, of 1514" in message
    assert "10.00 us at 100 Mbit/s" in message
    assert "(NC cycle at 600 us)" in message
    assert "frame_us" in (caught.value.hint or "")
    FAMILY.check(settings_of(f"bus:ec1.wire_ns={wire_ns}", "bus:ec1.overload=run"))


LONG = """
mdt = ["S-0-0047", "S-0-0036", "S-0-0080", "S-0-0092"]
at = ["S-0-0040", "S-0-0051", "S-0-0053", "S-0-0084", "S-0-0130", "S-0-0131", "S-0-0132",
      "S-0-0133", "S-0-0179", "S-0-0189", "S-0-0390"]
"""
AXIS = """
[axis.X{0}]
list = "x.lst"
segment = "ec1"
drive = "servo"
plant = "x{0}"
[plant.x{0}]
fmu = "AxisRig.Drives.ServoAxis"
"""


@pytest.mark.parametrize("overload", ["refuse", "run"])
@pytest.mark.parametrize(("axes", "fits"), [(25, True), (26, False)])
def test_an_image_that_is_longer_than_a_frame_is_refused_whatever_becomes_of_an_overload(
    tmp_path: Path, axes: int, fits: bool, overload: str
) -> None:
    """SERCOS: MDT 2 + 12, AT 2 + 40 and the mailbox 1 are 57 bytes for each axis. 25 make a frame
    of 16 + 2 * 16 + 12 + 1425 + 14 = 1499 of 1514 bytes (IEEE 802.3), one more 1556."""
    (tmp_path / "x.lst").write_text("getriebe[0].window 100\n", encoding="utf-8")
    more = "".join(AXIS.format(number) for number in range(1, axes))
    path = tmp_path / "rig.toml"
    path.write_text(
        f'base = "{(RIGS / "probe-z-sercos.toml").as_posix()}"\n[drive.servo]{LONG}{more}'
        f'[segment.ec1]\noverload = "{overload}"\n',
        encoding="utf-8",
    )
    settings = read_settings(*read_rig(path), [])
    if fits:
        FAMILY.check(settings)
        return
    with pytest.raises(UserError) as caught:
        FAMILY.check(settings)
    message = caught.value.message
    assert message.startswith("the process image does not fit into one frame on segment ec1:\n")
    assert f"process image of {axes} (LRW)" in message
    assert "frame 1556 bytes, at least 60, of 1514" in message
    assert caught.value.hint == "use another segment for some of its axes"
    assert caught.value.line == 1 + path.read_text().splitlines().index("[segment.ec1]")


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ("bus:ec1.frame_us=1000", "frame_us is after the end of the cycle"),
        ("bus:ec1.shift_us=1000", "shift_us is after the end of the cycle"),
        ("bus:ec1.frame_us=600", "the frame leaves at the instant of the NC cycle"),
        ("bus:ec1.wire_ns=Q=5", "wire_ns names no axis of it"),
        ("drive:servo.heartbeat_ms=100", "there is no heartbeat"),
        ("drive:servo.guard_time_ms=100", "there is no node guarding"),
        ("drive:servo.rpdo_timeout_ms=10", "the watchdog of the outputs is in the place"),
    ],
)
def test_what_a_line_has_not_is_refused_by_name(change: str, says: str) -> None:
    with pytest.raises(UserError) as caught:
        FAMILY.check(settings_of(change))
    assert says in caught.value.message


def test_of_several_names_that_a_line_lacks_the_first_is_named() -> None:
    """As the cell writes them, with the axes of the line."""
    with pytest.raises(UserError) as caught:
        FAMILY.check(settings_of("bus:ec1.wire_ns=Q=5 Z=7 A=9"))
    assert (caught.value.value, caught.value.allowed) == ("Q", "Z")


@pytest.mark.parametrize("frame_us", [599, 599.99, 600, 600.01, 601, 700, 999])
def test_a_frame_may_leave_before_and_after_the_nc_cycle_and_not_with_it(frame_us: float) -> None:
    """At 600 us nobody could say whether the cycle has the inputs of this frame.

    Shortly before it the frame is not back in time, which is refused too.
    """
    settings = settings_of(f"bus:ec1.frame_us={frame_us}", "bus:ec1.overload=run")
    if frame_us != 600:
        FAMILY.check(settings)
        return
    with pytest.raises(UserError, match="leaves at the instant of the NC cycle") as caught:
        FAMILY.check(settings)
    assert (caught.value.value, caught.value.allowed) == (
        600, "an instant before or after cycle_offset_us",
    )  # fmt: skip


SECOND_LINE = """
base = "{base}"
[segment.ec2]
carrier = "ethercat"
[axis.Y]
list = "{lists}/axis-y.lst"
segment = "ec2"
drive = "servo"
plant = "y"
[plant.y]
fmu = "AxisRig.Drives.ServoAxis"
"""


@pytest.mark.parametrize("key", ["wire_ns", "slave_ns", "drift_ppm", "clock_start_us"])
def test_the_terminal_of_a_line_may_have_keys_of_its_own(key: str) -> None:
    """By its name, as an axis; a line without one refuses it."""
    change = f"bus:ec1.{key}=terminal=5 Z=7"
    settings = settings_of(change, "bus:ec1.overload=run", rig="plc-timestamp-line.toml")
    FAMILY.check(settings)
    table = segment_of(settings, "ec1")
    assert (table.of(key, "terminal"), table.of(key, "Z")) == (5.0, 7.0)
    with pytest.raises(UserError, match=f"{key} names no axis of it") as caught:
        FAMILY.check(settings_of(change, "bus:ec1.overload=run"))
    assert caught.value.value == "terminal"


@pytest.mark.parametrize("line", ["ec1", "ec2"])
def test_of_two_lines_one_has_the_terminal_behind_its_drives(tmp_path: Path, line: str) -> None:
    """Its registers are in the image of that line alone, and positions begin with 1 on each."""
    path = tmp_path / "rig.toml"
    places = {"base": RIGS / "plc-timestamp-line.toml", "lists": RIGS / "lists"}
    text = SECOND_LINE.format(**{key: place.as_posix() for key, place in places.items()})
    path.write_text(f'{text}[plc.terminal]\nsegment = "{line}"\n', encoding="utf-8")
    settings = read_settings(*read_rig(path), [])
    slaves = {"ec1": ["Z"], "ec2": ["Y"]}
    for segment, axes in slaves.items():
        is_there = segment == line
        assert (terminal_on(settings, segment) is not None) is is_there
        assert slaves_on(settings, segment) == [*axes, *["terminal"] * is_there]
        assert terminal_position(settings, segment) == 2
        assert position_of(settings, axes[0]) == 1
        names = [name for name, _ in schedule_of(settings, segment).parts]
        assert f"process image of {1 + is_there} (LRW)" in names


@pytest.mark.parametrize(("period_us", "value"), [(1000, 1), (2000, 2), (4000, 4)])
def test_the_period_of_the_cycle_is_that_of_the_set_positions(
    tmp_path: Path, period_us: int, value: int
) -> None:
    """60C2: so many times 10^-3 s."""
    path = tmp_path / "rig.toml"
    base = (RIGS / "probe-z-ethercat.toml").as_posix()
    path.write_text(f'base = "{base}"\n[cycle]\nperiod_us = {period_us}\n', encoding="utf-8")
    settings = read_settings(*read_rig(path), [])
    written = [
        (step.sub, int.from_bytes(step.data, "little", signed=True))
        for step in axis_steps(settings, "Z")
        if isinstance(step, Write) and step.index == 0x60C2
    ]
    assert written == [(1, value), (2, -3)]


def test_the_terminal_of_a_line_is_passed_where_its_frame_is_in_the_cycle() -> None:
    """Later frames pass it later; behind the end of a cycle it is the begin of the next one.

    Two wires of 50 ns and the drive of 300 ns are before the terminal; the frame has 8 bytes of
    preamble, 16 of head, 16 + 16 of times, 12 + 61 of the image, 14 + 16 of states and clocks and
    4 of FCS, at 80 ns. The way back is as long, with 300 ns of the terminal.
    """
    rig = "plc-timestamp-line.toml"
    first = FAMILY.terminal_grid(settings_of(rig=rig))
    assert first is not None
    there_ns = 2 * 50 + 300 + (8 + 16 + 16 + 16 + 12 + 61 + 14 + 16 + 4) * 80
    assert (first.offset_ns, first.late_ns) == (there_ns, 2 * 50 + 300 + 300)
    for frame_us in (1, 300, 985, 999):
        found = FAMILY.terminal_grid(settings_of(f"bus:ec1.frame_us={frame_us}", rig=rig))
        assert found is not None
        assert (found.period_ns, found.late_ns) == (MS, first.late_ns)
        assert found.offset_ns == (first.offset_ns + frame_us * US) % MS
    assert FAMILY.terminal_grid(settings_of(rig="plc-timestamp-ethercat.toml")) is None


@pytest.mark.parametrize(
    ("rig", "watches"),
    [("plc-timestamp-line.toml", True), ("plc-timestamp-ethercat.toml", True),
     ("plc-signal.toml", True), ("plc-io-node.toml", False),
     ("distance-chapter10-task.toml", False), ("probe-z.toml", False)],
)  # fmt: skip
def test_clocks_are_watched_for_stamps_alone(rig: str, watches: bool) -> None:
    """A node on CAN has no stamps, nor has a task without a terminal."""
    settings = settings_of(rig=rig)
    assert watches_clocks(settings) is watches
    assert (settings.rig.plc_task is None) is (rig == "probe-z.toml")
