"""The rig has how drives are started; what a drive cannot do is refused with file and line."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.rig.canopen.checks import axis_steps
from axisrig.bench.rig.canopen.schedule import axis_telegrams
from axisrig.bench.rig.canopen.startup import StartUpKeys, drive_steps, start_up_settings
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.mapping import telegrams
from axisrig.kernel.drives.canopen.startup_steps import BusSettings
from axisrig.kernel.drives.canopen.startup_steps import Write as WriteStep
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
DRIVE = "[drive.servo]\nlead_mm = 10.0\n"
MAP = """\
pdo,transmission,inhibit_100us,index,sub,bits,signed,field,note
RPDO1,1,0,0x6040,0,16,no,controlword,
RPDO1,1,0,0x607A,0,32,yes,target,
RPDO1,1,0,0x60B8,0,16,no,probe_function,
RPDO2,1,0,0x6072,0,16,no,,torque limit for #DRIVE
TPDO1,1,0,0x6041,0,16,no,statusword,
TPDO1,1,0,0x6064,0,32,yes,actual,
TPDO1,1,0,0x60B9,0,16,no,probe_status,
TPDO2,1,0,latch,0,32,yes,latch,
"""
CYCLIC = """\
antr.function[0].id TORQUE
antr.function[0].wr_ident[0] 6072_00
antr.function[0].data_type UNS16
antr.function[0].commu CYCLIC
"""


def _refused(settings: Settings) -> UserError:
    with pytest.raises(UserError) as caught:
        check_rig(settings)
    return caught.value


def _written(settings: Settings) -> list[tuple[int, int, int]]:
    return [
        (step.index, step.sub, int.from_bytes(step.data, "little"))
        for step in axis_steps(settings, "Z")
        if isinstance(step, WriteStep)
    ]


def test_every_key_becomes_a_write(rig_file: Write, settings_of: Read) -> None:
    keys = """
sdo = [["0x6065:0", 0xFFFFFFFF], ["0x6066:0", 9]]
options = { quick_stop = 2, fault_reaction = 2, abort_connection = 1 }
heartbeat_ms = 100
consumer_ms = 300
sync_window_us = 900
mode = 8
"""
    cycle = ("cycle_offset_us = 600", "cycle_offset_us = 600\nheartbeat_ms = 50\nsync_counter = 10")
    settings = settings_of(rig_file((DRIVE, DRIVE + keys), cycle))
    check_rig(settings)
    written = _written(settings)
    for expected in (
        (0x6065, 0, 0xFFFFFFFF), (0x6066, 0, 9), (0x605A, 0, 2), (0x605E, 0, 2), (0x6007, 0, 1),
        (0x1017, 0, 100), (0x1016, 1, 127 << 16 | 300), (0x1007, 0, 900), (0x1019, 0, 10),
        (0x6060, 0, 8), (0x1005, 0, 0x80),
    ):  # fmt: skip
        assert expected in written, expected
    periods = [entry for entry in written if entry[0] in (0x1006, 0x1019)]
    # The counter may change only while the period is 0 (CiA 301, object 1019)
    assert periods == [(0x1006, 0, 0), (0x1019, 0, 10), (0x1006, 0, 1000)]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ('sdo = [["0x5FFF:0", 1]]', "drive servo of axis Z: the drive has no such object"),
        ('sdo = [["0x6041:0", 1]]', "does not let the object be written"),
        ('sdo = [["6065", 1]]', "write index and sub-index as in 0x6065:0"),
        ('sdo = [["0x6065:0"]]', "each write is an object and a whole number"),
        ("consumer_ms = 100", "the kernel sends no heartbeat"),
        ("heartbeat_ms = 100\nguard_time_ms = 100", "not by both"),
        ('eds = "none.eds"', "the EDS is no file"),
        ('pdo_map = "none.csv"', "the mapping table cannot be read"),
        ('boot = "perhaps"', "boot"),
        ("mode = 1", "the kernel sends a set value every cycle"),
        ("options = { brake = 1 }", "options"),
    ],
)
def test_what_cannot_be_is_told_with_its_place(
    rig_file: Write, settings_of: Read, line: str, message: str
) -> None:
    path = rig_file((DRIVE, f"{DRIVE}{line}\n"))
    with pytest.raises(UserError) as caught:
        check_rig(settings_of(path))
    error = caught.value
    assert message in error.message
    assert error.file is not None


@pytest.mark.long
def test_a_foreign_drive_is_checked_against_its_own_eds(rig_file: Write, settings_of: Read) -> None:
    """The same drive whose maker lets 6065 be read only."""
    text = eds_text(DriveProfile())
    section = text.index("[6065]")
    access = text.index("AccessType=rw", section)
    foreign = text[:access] + "AccessType=ro" + text[access + len("AccessType=rw") :]
    keys = 'eds = "foreign.eds"\nsdo = [["0x6065:0", 1000]]\n'
    path = rig_file((DRIVE, DRIVE + keys))
    (path.parent / "foreign.eds").write_text(text, encoding="utf-8")
    check_rig(settings_of(path))
    (path.parent / "foreign.eds").write_text(foreign, encoding="utf-8")
    error = _refused(settings_of(path))
    assert "does not let the object be written" in error.message
    assert (error.file, error.line) == (str(path), 12)


@pytest.mark.parametrize(
    ("lacks", "objects", "pdos"),
    [
        ("", [0x60BA, 0x60D5], {"RPDO1", "TPDO1", "TPDO2", "TPDO3"}),
        ("60D5", [0x60BA], {"RPDO1", "TPDO1", "TPDO2", "TPDO3"}),
        ("60FD", [0x60BA, 0x60D5], {"RPDO1", "TPDO1", "TPDO2"}),
    ],
)
def test_what_a_foreign_drive_lacks_by_its_eds_is_not_mapped(
    rig_file: Write, settings_of: Read, lacks: str, objects: list[int], pdos: set[str]
) -> None:
    path = rig_file((DRIVE, DRIVE + 'eds = "foreign.eds"\n'))
    text = eds_text(DriveProfile(lacks=lacks))
    (path.parent / "foreign.eds").write_text(text, encoding="utf-8")
    settings = settings_of(path)
    check_rig(settings)
    telegrams = axis_telegrams(settings, "Z")
    assert [mapped.index for mapped in telegrams["TPDO2"].objects] == objects
    assert set(telegrams) == pdos


def test_a_file_that_is_no_eds_is_told(rig_file: Write, settings_of: Read) -> None:
    path = rig_file((DRIVE, DRIVE + 'eds = "foreign.eds"\n'))
    (path.parent / "foreign.eds").write_text("<xml/>", encoding="utf-8")
    error = _refused(settings_of(path))
    assert "the EDS cannot be read" in error.message
    assert error.file == str(path.parent / "foreign.eds")


def test_own_telegrams_count_on_the_bus_and_carry_cyclic_functions(
    rig_file: Write, settings_of: Read
) -> None:
    path = rig_file((DRIVE, DRIVE + 'pdo_map = "map.csv"\n'))
    (path.parent / "map.csv").write_text(MAP, encoding="utf-8")
    with (path.parent / "lists" / "axis-z.lst").open("a", encoding="utf-8") as file:
        file.write(CYCLIC)
    settings = settings_of(path)
    check_rig(settings)
    assert list(axis_telegrams(settings, "Z")) == ["RPDO1", "RPDO2", "TPDO1", "TPDO2"]


def test_a_cyclic_function_that_no_rpdo_carries_is_refused(
    rig_file: Write, settings_of: Read
) -> None:
    path = rig_file()
    with (path.parent / "lists" / "axis-z.lst").open("a", encoding="utf-8") as file:
        file.write(CYCLIC)
    error = _refused(settings_of(path))
    assert "no RPDO carries its object freely" in error.message
    assert (error.file, error.value) == (str(path), "0x6072:0")
    lines = path.read_text(encoding="utf-8").splitlines()
    assert error.line is not None
    assert lines[error.line - 1].startswith("list = ")  # which declares it


def test_paths_of_a_base_are_relative_to_the_base(rig_file: Write, tmp_path: Path) -> None:
    folder = tmp_path / "upper"
    folder.mkdir()
    rig_file((DRIVE, DRIVE + 'pdo_map = "map.csv"\neds = "foreign.eds"\n'), name="base.toml")
    upper = folder / "upper.toml"
    upper.write_text('base = "../base.toml"\ntitle = "above"\n', encoding="utf-8")
    rig, _ = read_rig(upper)
    assert rig.drive["servo"].pdo_map == str(tmp_path / "map.csv")
    assert rig.drive["servo"].eds == str(tmp_path / "foreign.eds")


@pytest.mark.parametrize(
    ("missing", "period_us", "is_real", "given", "timeout_ms"),
    [
        (3, 1000, False, None, 5),  # 4.5 cycles
        (1, 1000, False, None, 3),  # 2.5
        (2, 4000, False, None, 14),
        (3, 500, False, None, 3),  # 2.25 ms
        (3, 1000, True, None, 100),  # no process keeps a few milliseconds for sure
        (30, 4000, True, None, 126),
        (3, 1000, False, 40, 40),
        (3, 1000, True, 7, 7),
    ],
)
def test_an_rpdo_may_be_missing_as_often_as_a_tpdo_and_half_a_cycle(
    missing: int, period_us: int, is_real: bool, given: int | None, timeout_ms: int
) -> None:
    """Deadline of the RPDO in ms, sub-index 5 of 1400 (CiA 301), rounded up."""
    keys = StartUpKeys(missing_cycles=missing, rpdo_timeout_ms=given)
    assert deadlines_ms(keys, period_us, is_real=is_real) == [timeout_ms]


@pytest.mark.parametrize(("interface", "timeout_ms"), [("simulated", 5), ("socketcan", 100)])
def test_the_deadline_of_an_axis_is_that_of_its_bus(
    rig_file: Write, settings_of: Read, interface: str, timeout_ms: int
) -> None:
    is_real = interface != "simulated"
    keys = [f"bus:can1.interface={interface}", "bus:can1.channel=can0"] if is_real else []
    settings = settings_of(rig_file(), *keys)
    assert [write for write in _written(settings) if write[:2] == (0x1400, 5)] == [
        (0x1400, 5, timeout_ms)
    ]


@pytest.mark.parametrize("keys", ["", 'profile = "late-status"\n'])
@pytest.mark.parametrize("has_eds", [False, True])
def test_a_profile_is_named_where_it_says_what_the_drive_has(
    rig_file: Write, settings_of: Read, keys: str, has_eds: bool
) -> None:
    """The EDS of a rig says it in its place, and the profile of our own is no news."""
    eds = 'eds = "foreign.eds"\n' if has_eds else ""
    path = rig_file((DRIVE, DRIVE + keys + eds + 'sdo = [["0x5FFF:0", 1]]\n'))
    (path.parent / "foreign.eds").write_text(eds_text(DriveProfile()), encoding="utf-8")
    error = _refused(settings_of(path))
    assert "the drive has no such object" in error.message
    assert ("(profile late-status)" in error.message) is (bool(keys) and not has_eds)
    assert "drive servo of axis Z" in error.message


def deadlines_ms(keys: StartUpKeys, period_us: int = 1000, *, is_real: bool = False) -> list[int]:
    """What a start-up writes to sub-index 5 of 1400 of node 3."""
    steps = drive_steps(
        keys,
        BusSettings(sync_period_us=period_us),
        telegrams(0x60BA, None, counter=True, inputs=True, second=False),
        3,
        DriveProfile(),
        is_real=is_real,
    )
    return [
        int.from_bytes(step.data, "little")
        for step in steps
        if isinstance(step, WriteStep) and (step.index, step.sub) == (0x1400, 5)
    ]


@pytest.mark.parametrize(("timeout_ms", "found"), [(0, []), (1, [1]), (0xFFFF, [0xFFFF])])
def test_a_deadline_of_nothing_is_none(timeout_ms: int, found: list[int]) -> None:
    """Sub-index 5 of 1400: 0 switches it off, where the rig says so; then nothing is written."""
    settings = start_up_settings(StartUpKeys(rpdo_timeout_ms=timeout_ms))
    assert settings.rpdo_timeout_ms == timeout_ms
    assert deadlines_ms(StartUpKeys(rpdo_timeout_ms=timeout_ms)) == found


def test_without_keys_the_settings_of_a_start_up_have_no_deadline() -> None:
    """It follows from the cycle of the bus, that these keys do not know."""
    assert start_up_settings(StartUpKeys()).rpdo_timeout_ms == 0
