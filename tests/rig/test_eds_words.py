"""An EDS or DCF is compared with its rig: what cannot be is refused, the rest warns."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.eds_changes import changed, without

from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.rig.canopen.checks import axis_steps
from axisrig.bench.rig.canopen.eds_words import eds_warnings
from axisrig.bench.rig.canopen.latches import describe_latches
from axisrig.bench.rig.canopen.schedule import (
    axis_telegrams,
    describe_schedules,
    fixed_frames,
    segment_schedules,
)
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.rig.ethercat.family import OnEthercat
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.startup_steps import Write as WriteStep
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
EDS = eds_text(DriveProfile())
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def test_the_eds_of_our_own_drive_is_no_reason_for_a_word(
    with_eds: Callable[..., Settings],
) -> None:
    settings = with_eds(EDS)
    check_rig(settings)
    assert eds_warnings(settings) == []


# Touch probe


@pytest.mark.parametrize("measures", [True, False])
def test_a_drive_without_touch_probe_is_led_and_nobody_measures_with_it(
    with_eds: Callable[..., Settings], tmp_path: Path, measures: bool
) -> None:
    """60B8, 60B9 and the latches are in no telegram; only who measures with it is warned."""
    eds = without(EDS, "60B", "60D", "60E4")
    axis = f"kopf.log_achs_name Z\nkenngr.messachse {measures:d}\n"
    (tmp_path / "lists" / "axis-z.lst").write_text(axis)
    settings = with_eds(eds)
    check_rig(settings)
    carried = {
        f"{mapped.index:X}"
        for telegram in axis_telegrams(settings, "Z").values()
        for mapped in telegram.objects
    }
    assert carried == {"6040", "607A", "6041", "6064", "60FD"}
    assert sum("no touch probe (60B8)" in line for line in describe_latches(settings)) == measures


@pytest.mark.parametrize("rig", ["probe-z.toml", "probe-z-ethercat.toml"])
@pytest.mark.parametrize("lacks", ["60B8 60B9 60BA", "60FD"])
def test_check_warns_of_a_measuring_axis_without_touch_probe_on_each_carrier(
    rig: str, lacks: str
) -> None:
    settings = settings_of(RIGS / rig, [f"drive:servo.lacks={lacks}"])
    check_rig(settings)
    known = [*describe_latches(settings), *OnEthercat().describe(settings)]
    lines = [line for line in known if "no touch probe (60B8)" in line]
    assert len(lines) == ("60B8" in lacks)
    assert all(line.startswith("warning: axis Z: drive servo ") for line in lines)


# Modes


@pytest.mark.long(but=3)
@pytest.mark.parametrize(
    ("modes", "mode", "is_warned"),
    [
        ("0x25", 8, True),  # pp, pv, hm
        ("0xA5", 8, False),
        ("0x1A5", 8, False),
        ("0x10025", 8, True),  # a bit of the maker besides
        ("0", 8, False),  # the file leaves it open
        ("", 8, False),
        ("0x25", -3, False),  # a mode of the maker has no bit
    ],
)
def test_csp_is_looked_for_in_6502(
    with_eds: Callable[..., Settings], modes: str, mode: int, is_warned: bool
) -> None:
    settings = with_eds(changed(EDS, "6502", DefaultValue=modes), f"mode = {mode}")
    check_rig(settings)
    warnings = eds_warnings(settings)
    assert [("axis Z" in text, "no mode 8" in text) for text in warnings] == [
        (True, True)
    ] * is_warned


@pytest.mark.long(but=2)
@pytest.mark.parametrize(
    ("low", "high", "is_refused"),
    [
        ("-9", "6", True),
        ("-9", "8", False),
        ("9", "10", True),
        ("0", "0", False),
        ("0x80", "6", True),
    ],
)
def test_a_mode_outside_the_limits_of_6060_is_refused(
    with_eds: Callable[..., Settings], low: str, high: str, is_refused: bool
) -> None:
    settings = with_eds(changed(EDS, "6060", LowLimit=low, HighLimit=high))
    if not is_refused:
        check_rig(settings)
        return
    with pytest.raises(UserError) as caught:
        check_rig(settings)
    assert "drive servo of axis Z: 0x6060:0" in caught.value.message
    low_value = -128 if low == "0x80" else int(low)
    assert (caught.value.value, caught.value.allowed) == (8, f"{low_value} to {high}")


@pytest.mark.long
def test_limits_count_for_every_write_of_the_start_up(with_eds: Callable[..., Settings]) -> None:
    text = changed(EDS, "6065", LowLimit="10", HighLimit="5000")
    for value, is_refused in ((10, False), (5000, False), (9, True), (5001, True)):
        settings = with_eds(text, f'sdo = [["0x6065:0", {value}]]')
        if not is_refused:
            check_rig(settings)
            continue
        with pytest.raises(UserError) as caught:
            check_rig(settings)
        assert (caught.value.value, caught.value.allowed) == (value, "10 to 5000")


# Bus


@pytest.mark.long(but=2)
@pytest.mark.parametrize(
    ("bitrate", "text", "is_warned"),
    [
        ("1_000_000", changed(EDS, "DeviceInfo", BaudRate_1000="0"), True),
        ("500_000", changed(EDS, "DeviceInfo", BaudRate_1000="0"), False),
        ("500_000", changed(EDS, "DeviceInfo", BaudRate_500="0"), True),
        ("1_000_000", re.sub(r"(?m)^BaudRate_.*\n", "", EDS), False),  # it says nothing
    ],
)
def test_the_bit_rate_of_the_segment_is_one_of_the_eds(
    with_eds: Callable[..., Settings], bitrate: str, text: str, is_warned: bool
) -> None:
    cycle = ("cycle_offset_us = 600", "cycle_offset_us = 4000\nperiod_us = 10000")
    settings = with_eds(text, "", ("bitrate = 1_000_000", f"bitrate = {bitrate}"), cycle)
    check_rig(settings)
    kbit = int(bitrate) // 1000
    assert [f"no {kbit} kbit/s" in warning for warning in eds_warnings(settings)] == [
        True
    ] * is_warned


@pytest.mark.long(but=2)
@pytest.mark.parametrize(
    ("node", "rate", "found"),
    [
        ("0x10", "500", "its DCF is for node 16 at 500 kbit/s, the rig has node 3 at 1000 kbit/s"),
        ("3", "500", "its DCF is for node 3 at 500 kbit/s, the rig has node 3 at 1000 kbit/s"),
        ("4", "1000", "its DCF is for node 4 at 1000 kbit/s, the rig has node 3 at 1000 kbit/s"),
        ("4", "", "its DCF is for node 4, the rig has node 3 at 1000 kbit/s"),
        ("3", "1000", ""),
        ("", "", ""),
    ],
)
def test_a_dcf_is_of_the_node_and_the_bit_rate_of_the_rig(
    with_eds: Callable[..., Settings], node: str, rate: str, found: str
) -> None:
    keys = [f"{key}={value}" for key, value in (("NodeID", node), ("Baudrate", rate)) if value]
    section = "\n".join(["[DeviceComissioning]", "NodeName=Z", *keys, "", ""])
    settings = with_eds(section + EDS, suffix="dcf")
    check_rig(settings)
    assert [text.partition("servo: ")[2] for text in eds_warnings(settings)] == [found] * bool(
        found
    )


@pytest.mark.long
def test_two_axes_are_compared_each_with_its_own_node(
    with_eds: Callable[..., Settings],
) -> None:
    """Both use the DCF of node 3: right for Z, not for Y."""
    second = """\
[axis.Y]
list = "lists/axis-y.lst"
segment = "can1"
node = 5
drive = "servo"
plant = "y"

[plant.y]
fmu = "AxisRig.Drives.ServoAxis"

[plant.z]
"""
    settings = with_eds(
        "[DeviceComissioning]\nNodeID=3\nBaudrate=1000\n\n" + EDS, "", ("[plant.z]\n", second)
    )
    (warning,) = eds_warnings(settings)
    assert warning.startswith("axis Y, drive servo: its DCF is for node 3")


# Device


@pytest.mark.long(but=2)
@pytest.mark.parametrize(
    ("device_type", "keys", "profile"),
    [
        ("0x000F0191", "", 401),
        ("0x000F0191", "device_type = 401", None),
        ("0x000F0191", "device_type = false", None),
        ("0x00020192", "device_type = 401", 402),
        ("0", "", None),
    ],
)
def test_the_profile_of_1000_is_that_of_the_rig(
    with_eds: Callable[..., Settings], device_type: str, keys: str, profile: int | None
) -> None:
    settings = with_eds(changed(EDS, "1000", DefaultValue=device_type), keys)
    check_rig(settings)
    warnings = eds_warnings(settings)
    assert [f"profile {profile}" in text for text in warnings] == [True] * (profile is not None)


@pytest.mark.parametrize(
    ("lacks", "is_warned"), [("1006 60C2", True), ("1006", False), ("60C2", False)]
)
def test_a_drive_that_nothing_gives_the_period_is_named(
    with_eds: Callable[..., Settings], lacks: str, is_warned: bool
) -> None:
    settings = with_eds(eds_text(DriveProfile(lacks=lacks)))
    check_rig(settings)
    assert ["60C2 nor 1006" in text for text in eds_warnings(settings)] == [True] * is_warned


@pytest.mark.parametrize(
    ("section", "keys", "is_warned"),
    [
        ("1803sub1", {"AccessType": "ro"}, False),  # off by default
        ("1803sub1", {"AccessType": "ro", "DefaultValue": "$NODEID+0x480"}, True),
        ("1803sub1", {"AccessType": "rw", "DefaultValue": "$NODEID+0x480"}, False),
    ],
)
def test_a_tpdo_that_cannot_be_switched_off_is_named(
    with_eds: Callable[..., Settings], section: str, keys: dict[str, str], is_warned: bool
) -> None:
    """TPDO4 is not in the kernel's mapping; it would be sent, and the sum of the bus has it."""
    settings = with_eds(changed(EDS, section, **keys))
    check_rig(settings)
    assert ["TPDO4" in text for text in eds_warnings(settings)] == [True] * is_warned
    table = "\n".join(describe_schedules(settings))
    assert ("Z.TPDO4 (not mapped)" in table) == is_warned


def test_bus_time_of_a_tpdo_that_nobody_mapped_is_in_the_sum(
    with_eds: Callable[..., Settings],
) -> None:
    """8 bytes with worst-case stuffing at 1 Mbit/s: 135 us (ISO 11898-1, data frame)."""
    fixed = {"AccessType": "ro", "DefaultValue": "$NODEID+0x480"}
    text = changed(changed(EDS, "1803sub1", **fixed), "1803sub2", DefaultValue="1")
    text = changed(text, "1A03sub0", DefaultValue="2")
    text = changed(text, "1A03sub1", DefaultValue="0x60640020")
    text = changed(text, "1A03sub2", DefaultValue="0x606C0020")
    before, after = (
        next(iter(segment_schedules(with_eds(each)).values())).last_tpdo_ns for each in (EDS, text)
    )
    bits = 8 * 8 + 44 + 3 + (34 + 8 * 8 - 1) // 4  # data, overhead, interval, stuff bits
    assert after - before == bits * 1000


@pytest.mark.parametrize(
    ("bits", "length"),
    [((32, 32), 8), ((32,), 4), ((8,), 1), ((8, 4), 2), ((1,), 1), ((16, 1), 3), ((), 0)],
)
def test_a_frame_that_nobody_mapped_has_whole_bytes_for_its_bits(
    with_eds: Callable[..., Settings], bits: tuple[int, ...], length: int
) -> None:
    """CiA 301, 7.3.3.1: the low byte of an entry of 1A03 is the length of its object in bits."""
    fixed = {"AccessType": "ro", "DefaultValue": "$NODEID+0x480"}
    text = changed(changed(EDS, "1803sub1", **fixed), "1803sub2", DefaultValue="1")
    text = changed(text, "1A03sub0", DefaultValue=str(len(bits)))
    for sub, count in enumerate(bits, start=1):
        text = changed(text, f"1A03sub{sub}", DefaultValue=f"0x{0x60640000 + count:08X}")
    ((kind, frame),) = fixed_frames(with_eds(text), "Z")
    assert (kind, frame.data_bytes, frame.name) == ("TPDO", length, "Z.TPDO4 (not mapped)")


@pytest.mark.parametrize(
    ("transmission", "comes"), [("1", "TPDO"), ("240", "TPDO"), ("254", "event"), ("255", "event")]
)
def test_such_a_tpdo_comes_as_its_transmission_type_says(
    with_eds: Callable[..., Settings], transmission: str, comes: str
) -> None:
    """Types up to 240 answer the SYNC, 254 and 255 come at any time (CiA 301)."""
    fixed = {"AccessType": "ro", "DefaultValue": "$NODEID+0x480"}
    text = changed(changed(EDS, "1803sub1", **fixed), "1803sub2", DefaultValue=transmission)
    ((kind, frame),) = fixed_frames(with_eds(text), "Z")
    assert (kind, frame.can_id) == (comes, 0x483)


@pytest.mark.parametrize(
    ("section", "keys", "message"),
    [
        ("1400sub1", {"AccessType": "ro"}, None),
        ("1800sub1", {"AccessType": "const"}, None),
        ("1800sub1", {"AccessType": "ro", "DefaultValue": "$NODEID+0x40000180"}, None),
        ("1800sub1", {"AccessType": "ro", "DefaultValue": "0x181"}, "TPDO1 has an identifier"),
        ("1400sub1", {"AccessType": "ro", "DefaultValue": "0x301"}, "RPDO1 has an identifier"),
        ("1800sub2", {"AccessType": "ro", "DefaultValue": "1"}, None),
        ("1800sub2", {"AccessType": "ro", "DefaultValue": "255"}, "does not let the object"),
    ],
)
def test_a_fixed_identifier_is_used_where_it_is_the_one_that_is_wanted(
    with_eds: Callable[..., Settings], section: str, keys: dict[str, str], message: str | None
) -> None:
    settings = with_eds(changed(EDS, section, **keys))
    if message is not None:
        with pytest.raises(UserError, match=message):
            check_rig(settings)
        return
    check_rig(settings)
    index, sub = (int(part, 16) for part in section.split("sub"))
    writes = [step for step in axis_steps(settings, "Z") if isinstance(step, WriteStep)]
    assert not [step for step in writes if (step.index, step.sub) == (index, sub)]
    assert [step for step in writes if (step.index, step.sub) == (0x1A00, 1)]


@pytest.mark.parametrize(
    ("default", "wanted", "is_warned"),
    [("0x2E1", 0x2E1, False), ("0x2E1", 0x2E2, True), ("0", 0x2E2, False)],
)
def test_the_identity_of_the_rig_is_that_of_the_eds(
    with_eds: Callable[..., Settings], default: str, wanted: int, is_warned: bool
) -> None:
    text = changed(EDS, "1018sub1", DefaultValue=default)
    warnings = eds_warnings(with_eds(text, f"identity = {{ vendor = {wanted} }}"))
    assert ["the vendor 0x2E1" in each for each in warnings] == [True] * is_warned


def test_mends_of_a_file_are_named_with_line_section_and_key(
    with_eds: Callable[..., Settings],
) -> None:
    text = changed(EDS, "6040", ObjectType="")
    for index in ("6041", "6064", "6060"):
        text = changed(text, index, ObjectType="")
    (warning,) = eds_warnings(with_eds(text))
    line = text.splitlines().index("[6040]") + 3
    assert f"its EDS, line {line} [6040] ObjectType, " in warning
    assert "and 1 more: is empty" in warning


# Arrays

SHORT = """\
[2100]
ParameterName=Gains
ObjectType=0x8
DataType=0x0006
AccessType=rw
PDOMapping=0
CompactSubObj={count}

"""


@pytest.mark.long(but=4)
@pytest.mark.parametrize(
    ("place", "is_refused"),
    [
        ("0x1010:3", False), ("0x1010:4", True),  # an array of 3
        ("0x2100:5", False), ("0x2100:6", True),  # one of 5 in the short form
        ("0x1010:9", True), ("0x2100:1", False), ("0x2100:0xFF", True),
        ("0x1018:9", True),  # a record
        ("0x6065:1", True),  # a variable
    ],
)  # fmt: skip
def test_a_sub_index_beyond_an_array_is_refused(
    with_eds: Callable[..., Settings], place: str, is_refused: bool
) -> None:
    value = int.from_bytes(b"save", "little") if place.startswith("0x1010") else 1
    settings = with_eds(EDS + SHORT.format(count="0x5"), f'sdo = [["{place}", {value}]]')
    if not is_refused:
        check_rig(settings)
        return
    with pytest.raises(UserError) as caught:
        check_rig(settings)
    assert "the drive has no such object" in caught.value.message
    assert caught.value.value == place.replace(":0x", ":")
    if "1010" in place:
        assert caught.value.allowed == "sub-index 0, 1, 2, 3"


@pytest.mark.long
def test_members_of_a_short_array_may_be_mapped_as_the_first_is(
    with_eds: Callable[..., Settings],
) -> None:
    """What the first member may do, the others may: here none in a PDO."""
    table = (
        "pdo,transmission,inhibit_100us,index,sub,bits,signed,field\n"
        "RPDO1,1,0,0x6040,0,16,no,controlword\n"
        "RPDO1,1,0,0x607A,0,32,yes,target\n"
        "TPDO1,1,0,0x6041,0,16,no,statusword\n"
        "TPDO1,1,0,0x6064,0,32,yes,actual\n"
        "TPDO2,1,0,0x2100,{sub},16,no,\n"
    )
    for mappable, sub, message in (
        ("1", 5, None), ("1", 6, "does not have"), ("0", 5, "no PDO may carry"),
    ):  # fmt: skip
        short = SHORT.format(count=5).replace("PDOMapping=0", f"PDOMapping={mappable}")
        settings = with_eds(EDS + short, f'pdo_map = "map-{mappable}-{sub}.csv"')
        Path(settings.rig.drive["servo"].pdo_map or "").write_text(
            table.format(sub=sub), encoding="utf-8"
        )
        if message is None:
            check_rig(settings)
            continue
        with pytest.raises(UserError, match=message):
            check_rig(settings)
