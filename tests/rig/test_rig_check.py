"""Checks of a rig beyond its form: references, nodes, lists, and the arithmetic of its buses."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.canopen.checks import check_latch_of
from axisrig.bench.rig.canopen.schedule import axis_telegrams, has_latch_counter, segment_schedules
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"

# Worst-case bits of a classic frame with 11 bit identifier, 3 bits of intermission included:
# 47 + 8 n + floor((34 + 8 n - 1) / 4), Davis et al. 2007
BITS = {0: 55, 4: 95, 6: 115, 8: 135}
PER_DRIVE_US = 2 * BITS[8] + BITS[4]  # RPDO1, TPDO1 and TPDO2 at 1 Mbit/s
SECOND_AXIS = """
[axis.Y]
list = "lists/axis-y.lst"
segment = "can1"
node = {node}
drive = "servo"
plant = "{plant}"

[plant.y]
fmu = "AxisRig.Drives.ServoAxis"

[axis.Z]
"""


def _refused(settings: Settings) -> UserError:
    with pytest.raises(UserError) as caught:
        check_rig(settings)
    return caught.value


def _line(path: Path, text: str) -> int:
    return 1 + next(n for n, line in enumerate(path.read_text().splitlines()) if text in line)


@pytest.mark.parametrize(
    ("key", "old", "unknown", "known"),
    [
        ("segment", 'segment = "can1"', "can9", "can1"),
        ("drive", 'drive = "servo"', "stepper", "servo"),
        ("plant", 'plant = "z"', "zz", "z, probe"),
        ("probe_1", 'probe_1 = "probe"', "prob", "z, probe"),
    ],
)
def test_a_reference_to_nothing_is_refused(
    rig_file: Write, settings_of: Read, key: str, old: str, unknown: str, known: str
) -> None:
    path = rig_file((old, f'{key} = "{unknown}"'))
    with pytest.raises(UserError) as caught:
        settings_of(path)
    error = caught.value
    assert f"axis Z: {key}" in error.message
    assert (error.file, error.line) == (str(path.resolve()), _line(path, f'"{unknown}"'))
    assert (error.value, error.allowed) == (unknown, known)


def test_a_rig_without_axes_is_refused(tmp_path: Path, rig_file: Write, settings_of: Read) -> None:
    text = rig_file().read_text()
    without = re.sub(r"\[axis\.Z\].*?(?=\[plant)", "[axis]\n", text, flags=re.DOTALL)
    path = tmp_path / "none.toml"
    path.write_text(without)
    assert "no axis" in _refused(settings_of(path)).message


def test_one_node_id_twice_on_a_segment_is_refused(rig_file: Write, settings_of: Read) -> None:
    path = rig_file(("[axis.Z]\n", SECOND_AXIS.format(node=3, plant="y")))
    error = _refused(settings_of(path))
    assert "same node id" in error.message
    assert "can1" in error.message
    assert error.value == 3
    assert error.line == _line(path, "[axis.Z]") + 3  # the second of the two


def test_one_node_id_on_two_segments_is_fine(rig_file: Write, settings_of: Read) -> None:
    second = SECOND_AXIS.format(node=3, plant="y").replace('"can1"', '"can2"')
    check_rig(settings_of(rig_file(("[axis.Z]\n", "[segment.can2]\n" + second))))


def test_two_axes_on_one_plant_are_refused(rig_file: Write, settings_of: Read) -> None:
    path = rig_file(("[axis.Z]\n", SECOND_AXIS.format(node=4, plant="z")))
    error = _refused(settings_of(path))
    assert "one plant" in error.message
    assert error.value == "z"


def test_the_list_of_another_axis_is_refused(rig_file: Write, settings_of: Read) -> None:
    path = rig_file(("axis-z.lst", "axis-x.lst"))
    error = _refused(settings_of(path))
    assert error.file == str(path.parent.resolve() / "lists" / "axis-x.lst")
    assert (error.value, error.allowed) == ("X", "Z")


def test_a_list_without_a_name_fits_any_axis(
    rig_file: Write, settings_of: Read, tmp_path: Path
) -> None:
    (tmp_path / "lists" / "axis-z.lst").write_text("kenngr.messachse 1\n")
    check_rig(settings_of(rig_file()))


# Time on the bus


@pytest.mark.parametrize("offset_us", [1000, 1500])
def test_a_cycle_offset_outside_the_period_is_refused(
    rig_file: Write, settings_of: Read, offset_us: int
) -> None:
    path = rig_file(("cycle_offset_us = 600", f"cycle_offset_us = {offset_us}"))
    error = _refused(settings_of(path))
    assert error.line == _line(path, "cycle_offset_us")
    assert (error.value, error.allowed) == (offset_us, "0 .. 999 us")


@pytest.mark.parametrize(
    ("offset_us", "fits"),
    # An event frame of 95 us is on the wire, then SYNC 55, TPDO1 135 and TPDO2 95: the last TPDO
    # is delivered 3 bits before 380 us. RPDO1: 95 + 135 us behind the offset, 3 bits before the
    # next SYNC at the latest.
    [(100, False), (376, False), (377, True), (600, True), (770, True), (771, False)],
)
def test_the_cycle_offset_must_lie_between_tpdos_and_rpdos(
    rig_file: Write, settings_of: Read, offset_us: int, fits: bool
) -> None:
    path = rig_file(("cycle_offset_us = 600", f"cycle_offset_us = {offset_us}"))
    settings = settings_of(path)
    if fits:
        check_rig(settings)
        return
    error = _refused(settings)
    assert "does not fit on segment can1" in error.message
    assert "over" in error.message
    assert error.line == _line(path, "[segment.can1]")
    assert "cycle_offset_us" in (error.hint or "")


def test_three_drives_on_one_segment_are_refused_with_the_arithmetic(
    tmp_path: Path, settings_of: Read
) -> None:
    """SYNC and three drives take 55 + 3 * 365 = 1150 us of 1000 us."""
    path = tmp_path / "three.toml"
    path.write_text(
        f'base = "{(RIGS / "probe-xyz.toml").as_posix()}"\n'
        f'{TWO_ON_CAN1}[axis.Z]\nsegment = "can1"\n'
    )
    error = _refused(settings_of(path))
    lines = error.message.splitlines()
    assert "does not fit on segment can1" in lines[0]
    for frame in ("SYNC", *(f"{a}.{p}PDO1" for a in "XYZ" for p in "RT"), "Z.TPDO2", "X.TPDO3"):
        assert any(frame in line for line in lines), frame
    (total,) = [line for line in lines if line.startswith("cyclic frames")]
    assert "1150.0 of 1000.0 us" in total
    assert "150.0 over" in total


def test_a_slower_segment_is_refused_where_a_plan_asks_for_it(
    rig_file: Write, settings_of: Read
) -> None:
    """At 500 kbit/s SYNC and one drive take 2 * 420 = 840 us: too late for both limits."""
    settings = settings_of(rig_file(), "bus:can1.bitrate=500000")
    assert segment_schedules(settings)["can1"].busy_ns == 840_000
    assert "does not fit" in _refused(settings).message


TWO_ON_CAN1 = '[axis.Y]\nsegment = "can1"\n'


def _two_on_can1(folder: Path, more: str = "") -> Path:
    """X and Y share a segment, Z has one of its own."""
    path = folder / "shared.toml"
    base = (RIGS / "probe-xyz.toml").as_posix()
    path.write_text(f'base = "{base}"\n{TWO_ON_CAN1}{more}', encoding="utf-8")
    return path


def test_busy_time_of_one_drive_and_of_two(tmp_path: Path, settings_of: Read) -> None:
    schedules = segment_schedules(settings_of(_two_on_can1(tmp_path)))
    assert schedules["can1"].busy_ns == 785_000
    assert schedules["can1"].busy_ns == (BITS[0] + 2 * PER_DRIVE_US) * 1000
    # Alone on its segment, a drive has room for the counter of its latch: two bytes more
    assert schedules["can3"].busy_ns == (BITS[0] + PER_DRIVE_US + BITS[6] - BITS[4]) * 1000
    shipped = segment_schedules(settings_of(RIGS / "probe-xyz.toml"))
    assert {shipped[name].busy_ns for name in shipped} == {schedules["can3"].busy_ns}
    assert schedules["can1"].event_ns == 2 * BITS[4] * 1000
    # One event frame, SYNC and the TPDOs of two drives, delivered before the intermission
    last_us = BITS[4] + BITS[0] + 2 * (BITS[8] + BITS[4]) - 3
    assert schedules["can1"].last_tpdo_ns == last_us * 1000


@pytest.mark.parametrize("path", sorted(RIGS.glob("*.toml")), ids=lambda path: path.name)
def test_shipped_rigs_pass(settings_of: Read, path: Path) -> None:
    check_rig(settings_of(path))


@pytest.mark.parametrize(
    ("assignments", "latch"),
    [
        ((), 0x60BA),
        (("set:Z.kenngr.measure.edge=NEG",), 0x60BB),
        (("set:Z.kenngr.measure.input=2",), 0x60BC),
        (("set:Z.kenngr.measure.input=2", "set:Z.kenngr.measure.edge=NEG"), 0x60BD),
        (("set:Z.kenngr.mess_neg_flanke=1",), 0x60BB),
    ],
)
def test_the_latch_object_follows_from_input_and_edge(
    rig_file: Write, settings_of: Read, assignments: tuple[str, ...], latch: int
) -> None:
    telegrams = axis_telegrams(settings_of(rig_file(), *assignments), "Z")
    counter = latch + 0x1B  # 60D5 to 60D8 belong to 60BA to 60BD
    assert [mapped.index for mapped in telegrams["TPDO2"].objects] == [latch, counter]


def test_the_counter_of_the_latch_comes_along_where_the_bus_has_room(
    tmp_path: Path, settings_of: Read
) -> None:
    """Two drives at 1 ms with counters end at 1015 us in the worst case; so they do without."""
    settings = settings_of(_two_on_can1(tmp_path))
    assert [has_latch_counter(settings, name) for name in "XYZ"] == [False, False, True]
    assert len(axis_telegrams(settings, "X")["TPDO2"].objects) == 1
    path = _two_on_can1(tmp_path, "[cycle]\nperiod_us = 2000\ncycle_offset_us = 700\n")
    assert all(has_latch_counter(settings_of(path), name) for name in "XYZ")


@pytest.mark.parametrize(
    ("habit", "objects", "has_inputs"),
    [
        ('profile = "ep7211-like"', [0x60BA], True),
        ('lacks = "60D6"', [0x60BA, 0x60D5], True),
        ('lacks = "60FD"', [0x60BA, 0x60D5], False),
    ],
)
def test_what_a_drive_lacks_is_not_mapped(
    rig_file: Write, settings_of: Read, habit: str, objects: list[int], has_inputs: bool
) -> None:
    settings = settings_of(rig_file(("lead_mm = 10.0", f"lead_mm = 10.0\n{habit}")))
    check_rig(settings)
    telegrams = axis_telegrams(settings, "Z")
    assert [mapped.index for mapped in telegrams["TPDO2"].objects] == objects
    assert ("TPDO3" in telegrams) is has_inputs


def test_a_probe_input_that_the_drive_lacks_is_refused(rig_file: Write, settings_of: Read) -> None:
    path = rig_file(("lead_mm = 10.0", 'profile = "epos4-like"'))
    error = _refused(settings_of(path, "set:Z.kenngr.measure.input=2"))
    assert "60BC" in str(error)
    assert str(error).startswith("--set set:Z.kenngr.measure.input=2: ")


def test_a_second_encoder_to_latch_must_be_there(rig_file: Write, settings_of: Read) -> None:
    path = rig_file(("lead_mm = 10.0", 'lead_mm = 10.0\nlatch_encoder = "second"'))
    error = _refused(settings_of(path))
    assert "axis Z has none" in error.message
    assert error.line == _line(path, "latch_encoder")
    path = rig_file(
        ("lead_mm = 10.0", 'lead_mm = 10.0\nlatch_encoder = "second"'),
        ('drive = "servo"', 'drive = "servo"\nencoder_2 = "load"'),
    )
    check_rig(settings_of(path))


def test_drive_defined_needs_60d0(rig_file: Write, settings_of: Read) -> None:
    path = rig_file(("lead_mm = 10.0", 'lead_mm = 10.0\nlacks = "60D0"'))
    asked = "set:Z.antr.canopen.probing_trigger_source"
    error = _refused(settings_of(path, f"{asked}=DRIVE_DEFINED"))
    assert "60D0:1" in error.message
    assert error.allowed == "CNC_DEFINED"
    check_rig(settings_of(path, f"{asked}=CNC_DEFINED"))
    check_rig(settings_of(path, f"{asked}=DEFAULT"))


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("lacks", ["60D0.1", "60D0.2", "60D0"])
@pytest.mark.parametrize("bits", ["latched", "ignored"])
def test_each_input_has_a_trigger_source_of_its_own(
    rig_file: Write, settings_of: Read, number: int, lacks: str, bits: str
) -> None:
    """60D0:1 is that of probe 1; a drive that ignores the bits for it needs none."""
    keys = f'lead_mm = 10.0\nlacks = "{lacks}"\n'
    keys += 'source_bits = "ignored"\n' if bits == "ignored" else ""
    settings = settings_of(
        rig_file(("lead_mm = 10.0", keys)),
        f"set:Z.kenngr.measure.input={number}",
        "set:Z.antr.canopen.probing_trigger_source=DRIVE_DEFINED",
    )
    if bits == "ignored" or lacks == f"60D0.{3 - number}":
        check_latch_of(settings, "Z")
        return
    with pytest.raises(UserError, match=f"asks for object 60D0:{number} and the drive does not"):
        check_latch_of(settings, "Z")


def test_all_mistakes_of_a_rig_are_reported_at_once(rig_file: Write, settings_of: Read) -> None:
    """Four of them, none of which follows from another: cycle, plant, name and number of the node.

    The arithmetic of the bus is not asked of a rig whose wiring is wrong.
    """
    more = '[axis.G]\nlist = "lists/axis-z.lst"\nsegment = "can1"\nnode = 3\ndrive = "servo"\n'
    path = rig_file(
        ("cycle_offset_us = 600", "cycle_offset_us = 1600"),
        ("[plant.z]", f'{more}plant = "z"\n\n[plant.z]'),
    )
    with pytest.raises(UserError) as caught:
        check_rig(settings_of(path))
    found = [str(error) for error in (caught.value, *caught.value.further)]
    for words in (
        "the NC cycle must start within the period",
        "two axes cannot drive one plant",
        "an axis needs a name of its own",
        "axes Z and G have the same node id on segment can1",
    ):
        assert sum(words in text for text in found) == 1, (words, found)


@pytest.mark.parametrize(
    "scaling",
    [
        0x00,  # SERCOS, S-0-0076: bits 0 to 2 are the kind of scaling, 0 is none
        0x04,
        0x08,
    ],
)
def test_a_drive_that_cannot_say_what_it_is_is_refused_at_its_table(
    settings_of: Read, tmp_path: Path, scaling: int
) -> None:
    rig = tmp_path / "rig.toml"
    base = (RIGS / "probe-z-sercos.toml").as_posix()
    rig.write_text(
        f'base = "{base}"\n\n[drive.servo]\nidents = [["S-0-0076", {scaling}]]\n', encoding="utf-8"
    )
    error = _refused(settings_of(rig))
    assert "scaling: positions have no unit" in error.message
    assert (error.value, error.allowed) == (
        f"S-0-0076 = 0x{scaling:02X}", "0x09 linear, 0x0A rotary",
    )  # fmt: skip
    assert (error.file, error.line) == (str(rig), 3)
