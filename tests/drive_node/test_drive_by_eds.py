"""A simulated drive that has the objects of somebody else's EDS (CiA 306-1, CiA 301)."""

import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from canopen.objectdictionary import ObjectDictionary, ODRecord, ODVariable
from canopen.sdo.exceptions import SdoAbortedError
from tests.eds_changes import changed, without

from axisrig.bench.drive.canopen.node import Document
from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.foreign import foreign_table, power_on_values
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.canopen.dictionary import read_eds

Make = Callable[..., Any]
NODE = 3
OFF = 0x8000_0000
"""Bit of a COB-ID: the PDO does not exist."""
NO_OBJECT, NO_SUB, READ_ONLY = 0x06020000, 0x06090011, 0x06010002
TOO_LOW, TOO_HIGH, TOO_LONG, WRITE_ONLY = 0x06090032, 0x06090031, 0x06070012, 0x06010001
"""Abort codes of CiA 301."""

VENDOR = """
[2000]
ParameterName=Gain
ObjectType=0x7
DataType=0x0003
AccessType=rw
LowLimit=-100
HighLimit=100
DefaultValue=-7
PDOMapping=1

[2001]
ParameterName=Motor
ObjectType=0x9
SubNumber=3

[2001sub0]
ParameterName=Highest sub-index
DataType=0x0005
AccessType=const
DefaultValue=2

[2001sub1]
ParameterName=Inductance
DataType=0x0008
AccessType=rw
DefaultValue=1.5

[2001sub2]
ParameterName=Label
DataType=0x0009
AccessType=rw
DefaultValue=motor A

[2002]
ParameterName=Firmware
ObjectType=0x2
DataType=0x000F
AccessType=wo

[2003]
ParameterName=Serial
DataType=0x001B
AccessType=ro
DefaultValue=0x123456789A

[2004]
ParameterName=COB-ID of its own
DataType=0x0007
AccessType=rw
DefaultValue=$NODEID+0x40

[6F00]
ParameterName=In the range of the profile
DataType=0x0006
AccessType=rw
DefaultValue=5
"""


FIFTH = """
[1804]
ParameterName=TPDO 5
ObjectType=0x9
SubNumber=3

[1804sub0]
ParameterName=Highest sub-index
DataType=0x0005
AccessType=const
DefaultValue=2

[1804sub1]
ParameterName=COB-ID
DataType=0x0007
AccessType=rw
DefaultValue=$NODEID+0x1C0

[1804sub2]
ParameterName=Transmission type
DataType=0x0005
AccessType=rw
DefaultValue=1

[1A04]
ParameterName=TPDO 5 mapping
ObjectType=0x9
SubNumber=2

[1A04sub0]
ParameterName=Number of mapped objects
DataType=0x0005
AccessType=rw
DefaultValue=1

[1A04sub1]
ParameterName=Mapped object 1
DataType=0x0007
AccessType=rw
DefaultValue=0x60410010
"""


def foreign() -> str:
    """Return an EDS that differs from that of our model in everything that a drive takes of it."""
    text = eds_text(DriveProfile()) + VENDOR
    for index in ("1017", "60E0", "1402", "1602"):
        text = without(text, index)
    text = changed(text, "1018sub1", DefaultValue="0x2E1")
    text = changed(text, "6065", DefaultValue="4711", HighLimit="10000")
    text = changed(text, "6081", AccessType="ro", DefaultValue="1234")
    text = changed(text, "1A00sub0", DefaultValue="2")
    text = changed(text, "1A00sub1", DefaultValue="0x60410010")
    text = changed(text, "1A00sub2", DefaultValue="0x60640020")
    text = changed(text, "1A02sub0", DefaultValue="1")
    text += FIFTH
    return changed(text, "1A02sub1", DefaultValue="0x20000010")


@pytest.fixture
def bench(drive_bench: Make, tmp_path: Path) -> Any:
    path = tmp_path / "foreign.eds"
    path.write_text(foreign(), encoding="ascii")
    return drive_bench(document=Document(read_eds(str(path), NODE), path.read_bytes()))


def aborted(call: Callable[[], object]) -> int:
    with pytest.raises(SdoAbortedError) as error:
        call()
    return int(error.value.code)


@pytest.mark.long
def test_identity_and_objects_are_those_of_the_file(bench: Any) -> None:
    sdo = bench.remote.sdo
    assert sdo.upload(0x1018, 1) == struct.pack("<I", 0x2E1)
    assert aborted(lambda: sdo.upload(0x1017, 0)) == NO_OBJECT
    assert aborted(lambda: sdo.upload(0x60E0, 0)) == NO_OBJECT
    assert aborted(lambda: sdo.upload(0x2001, 7)) == NO_SUB
    assert sdo.upload(0x1021, 0) == foreign().encode("ascii")


@pytest.mark.long(but=2)
@pytest.mark.parametrize(
    ("index", "sub", "data"),
    [
        (0x2000, 0, struct.pack("<h", -7)),
        (0x2001, 0, b"\2"),
        (0x2001, 1, struct.pack("<f", 1.5)),
        (0x2001, 2, b"motor A"),
        (0x2003, 0, struct.pack("<Q", 0x123456789A)),
        (0x2004, 0, struct.pack("<I", 0x40 + NODE)),
        (0x6F00, 0, struct.pack("<H", 5)),
        (0x6065, 0, struct.pack("<I", 4711)),
    ],
)
def test_values_at_power_on_are_those_of_the_file(
    bench: Any, index: int, sub: int, data: bytes
) -> None:
    assert bench.remote.sdo.upload(index, sub) == data


@pytest.mark.parametrize(("read_for", "node_id"), [(NODE, NODE), (NODE, 7), (9, 2), (5, 127)])
@pytest.mark.parametrize("more", ["", "\n[DeviceComissioning]\nNodeID=9\nBaudrate=500\n"])
def test_what_follows_the_node_number_follows_that_of_the_drive(
    tmp_path: Path, read_for: int, node_id: int, more: str
) -> None:
    """The number that an EDS, or a DCF, was read for may be another one: LSS has given it since."""
    path = tmp_path / "foreign.eds"
    path.write_text(foreign() + more, encoding="ascii")
    table = foreign_table(DriveProfile(), read_eds(str(path), read_for))
    values = table.defaults(node_id)
    assert values[0x2004, 0] == 0x40 + node_id
    assert values[0x1804, 1] == 0x1C0 + node_id
    assert values[0x2000, 0] == -7
    assert values[0x6F00, 0] == 5


@pytest.mark.long
@pytest.mark.parametrize("place", [1, 2])
def test_a_default_mapping_with_an_object_that_nothing_carries_is_empty(
    tmp_path: Path, place: int
) -> None:
    """7F00 is in no object dictionary; the other mappings stay."""
    path = tmp_path / "foreign.eds"
    text = changed(foreign(), f"1A00sub{place}", DefaultValue="0x7F000010")
    path.write_text(text, encoding="ascii")
    values = foreign_table(DriveProfile(), read_eds(str(path), NODE)).defaults(NODE)
    assert values[0x1A00, 0] == 0
    path.write_text(foreign(), encoding="ascii")
    as_listed = foreign_table(DriveProfile(), read_eds(str(path), NODE)).defaults(NODE)
    assert as_listed[0x1A00, 0] == 2
    assert values[0x1A02, 0] == as_listed[0x1A02, 0] == 1


def test_the_process_image_begins_as_the_file_says() -> None:
    """Objects of CiA 402 that can be written, with values that the model knows (CiA 402-2); those
    of the communication, of the maker and of the rig keep their own.
    """
    values: dict[tuple[int, int], Any] = {
        (0x6065, 0): 4711, (0x607D, 1): -5, (0x607D, 2): 7, (0x6099, 1): 9, (0x6099, 2): 3,
        (0x605A, 0): 8, (0x6098, 0): -4, (0x60FF, 0): 0,
    }  # fmt: skip
    kept = {
        (0x1017, 0): 100, (0x2000, 0): 1, (0x6041, 0): 1, (0x6064, 0): 1,
        (0x6040, 0): 15, (0x6060, 0): 8, (0x608F, 1): 5, (0x6091, 2): 3, (0x6092, 1): 1,
        (0x60B8, 0): 1, (0x60D0, 2): 1, (0x60E6, 1): 5, (0x60EB, 1): 5,
        (0x605B, 0): 2, (0x605D, 0): 0, (0x6086, 0): 2, (0x6067, 0): None, (0x6072, 0): "1000",
    }  # fmt: skip
    od = ObjectDictionary()
    for (index, sub), value in {**values, **kept}.items():
        one = ODVariable(f"{index:X}sub{sub}", index, sub)
        one.default = value
        if not sub:
            od.add_object(one)
            continue
        if index not in od:
            od.add_object(ODRecord(f"{index:X}", index))
        od[index].add_member(one)
    found = {key: (name, value) for key, name, value in power_on_values(od)}
    assert found == {
        (0x6065, 0): ("following_window", 4711),
        (0x607D, 1): ("software_limit_min", -5), (0x607D, 2): ("software_limit_max", 7),
        (0x6099, 1): ("homing_speed_switch", 9), (0x6099, 2): ("homing_speed_zero", 3),
        (0x605A, 0): ("quick_stop_option", 8), (0x6098, 0): ("homing_method", -4),
        (0x60FF, 0): ("target_velocity", 0),
    }  # fmt: skip


def test_limits_and_access_are_those_of_the_file(bench: Any) -> None:
    sdo = bench.remote.sdo
    assert aborted(lambda: sdo.download(0x6065, 0, struct.pack("<I", 10001))) == TOO_HIGH
    assert aborted(lambda: sdo.download(0x2000, 0, struct.pack("<h", -101))) == TOO_LOW
    assert aborted(lambda: sdo.download(0x6081, 0, bytes(4))) == READ_ONLY
    assert aborted(lambda: sdo.download(0x2003, 0, bytes(8))) == READ_ONLY
    assert aborted(lambda: sdo.upload(0x2002, 0)) == WRITE_ONLY


def test_a_limit_of_0_and_the_most_bytes_are_limits(drive_bench: Make, tmp_path: Path) -> None:
    """LowLimit = 0 of a signed object (CiA 306-1); a DOMAIN takes 65536 bytes and no more."""
    path = tmp_path / "foreign.eds"
    text = changed(changed(foreign(), "2000", LowLimit="0"), "2000", DefaultValue="7")
    path.write_text(text, encoding="ascii")
    bench = drive_bench(document=Document(read_eds(str(path), NODE), path.read_bytes()))
    objects = bench.node.slave.objects
    assert aborted(lambda: objects.download(0x2000, 0, struct.pack("<h", -1))) == TOO_LOW
    for value in (0, 100):
        objects.download(0x2000, 0, struct.pack("<h", value))
        assert objects.upload(0x2000, 0) == struct.pack("<h", value)
    objects.download(0x2002, 0, bytes(1 << 16))
    assert aborted(lambda: objects.download(0x2002, 0, bytes((1 << 16) + 1))) == TOO_LONG


def test_objects_of_the_maker_are_memory_until_a_reset(bench: Any) -> None:
    sdo = bench.remote.sdo
    for index, sub, data in (
        (0x2000, 0, struct.pack("<h", 100)),
        (0x2001, 1, struct.pack("<f", -0.25)),
        (0x2001, 2, b"a label longer than a segment"),
        (0x6F00, 0, struct.pack("<H", 77)),
    ):
        before = sdo.upload(index, sub)
        sdo.download(index, sub, data)
        assert sdo.upload(index, sub) == data != before
    bench.remote.nmt.send_command(0x81)
    bench.run_to_ms(bench.scheduler.now_ns / 1e6 + 50)
    assert sdo.upload(0x2000, 0) == struct.pack("<h", -7)
    assert sdo.upload(0x2001, 2) == b"motor A"
    assert sdo.upload(0x6065, 0) == struct.pack("<I", 4711)


@pytest.mark.long
@pytest.mark.parametrize("block", [True, False])
def test_a_domain_takes_as_many_bytes_as_come(bench: Any, block: bool) -> None:
    sdo = bench.remote.sdo
    for size in (1, 4, 900):
        data = bytes(number & 0xFF for number in range(size))
        with sdo.open(0x2002, 0, "wb", size=size, block_transfer=block, buffering=1024) as file:
            file.write(data)
        assert bench.node.slave.objects._values[0x2002, 0] == data
    assert aborted(lambda: sdo.download(0x2002, 0, bytes(70_000))) == TOO_LONG


def test_the_default_mapping_is_that_of_the_file(bench: Any) -> None:
    """TPDO1 carries 6041 and 6064 alone, TPDO3 an object of the maker."""
    bench.remote.sdo.download(0x1802, 2, b"\x01")
    bench.operational()
    bench.sync_at_ms(5)
    (data,) = bench.frames(0x180 + NODE)
    assert len(data) == 6
    assert bench.frames(0x380 + NODE) == [struct.pack("<h", -7)]


def test_objects_of_the_maker_are_in_pdos_what_they_are_for_sdo(bench: Any) -> None:
    """Beside an object of the model in one PDO, and the other way round in the next.

    An RPDO acts at the SYNC after it, before the drive samples what its TPDOs carry.
    """
    sdo = bench.remote.sdo
    for number, base, entries in (
        (0x1802, 0x380, (0x20000010, 0x60410010)),
        (0x1401, 0x300, (0x60600008, 0x20000010)),
    ):
        sdo.download(number, 1, struct.pack("<I", OFF | base + NODE))
        sdo.download(number + 0x200, 0, b"\x00")
        for sub, entry in enumerate(entries, 1):
            sdo.download(number + 0x200, sub, struct.pack("<I", entry))
        sdo.download(number + 0x200, 0, b"\x02")
        sdo.download(number, 2, b"\x01")
        sdo.download(number, 1, struct.pack("<I", base + NODE))
    first = round(bench.scheduler.now_ns / 1e6) + 2
    bench.operational(first)
    for at, value in ((first + 2, -7), (first + 3, 100), (first + 4, 100)):
        bench.sync_at_ms(at)
        word = struct.unpack("<H", bench.frames(0x180 + NODE)[-1][:2])[0]
        assert bench.frames(0x380 + NODE)[-1] == struct.pack("<hH", value, word)
        bench.master.send_message(0x300 + NODE, struct.pack("<bh", 1, 100))
    assert sdo.upload(0x2000, 0) == struct.pack("<h", 100)
    assert sdo.upload(0x6060, 0) == b"\x01"


@pytest.mark.parametrize("entry", [0x20010220, 0x20010120, 0x20020008, 0x6F000010, 0x20000008])
def test_what_the_file_does_not_map_or_is_no_number_is_in_no_pdo(bench: Any, entry: int) -> None:
    """A text, a float, a domain, an object without PDOMapping, another length."""
    sdo = bench.remote.sdo
    sdo.download(0x1802, 1, struct.pack("<I", OFF | 0x380 + NODE))
    sdo.download(0x1A02, 0, b"\x00")
    assert aborted(lambda: sdo.download(0x1A02, 1, struct.pack("<I", entry))) == 0x06040041


def test_a_fifth_pdo_with_an_identifier_of_its_own(bench: Any) -> None:
    sdo = bench.remote.sdo
    assert sdo.upload(0x1804, 1) == struct.pack("<I", 0x1C0 + NODE)
    bench.operational()
    bench.sync_at_ms(5)
    (data,) = bench.frames(0x1C0 + NODE)
    assert data == bench.frames(0x180 + NODE)[0][:2]
    sdo.download(0x1804, 1, struct.pack("<I", 0x80000000 | 0x1C0 + NODE))
    sdo.download(0x1804, 1, struct.pack("<I", 0x1D0))
    bench.sync_at_ms(round(bench.scheduler.now_ns / 1e6) + 5)
    assert len(bench.frames(0x1C0 + NODE)) == 1
    assert len(bench.frames(0x1D0)) == 1


def test_a_fifth_pdo_that_is_received_changes_while_the_node_runs(
    drive_bench: Make, tmp_path: Path
) -> None:
    """Another identifier for RPDO 5 leaves RPDO 1 as it is; both take the target 607A."""
    path = tmp_path / "foreign.eds"
    fifth = FIFTH.replace("1804", "1404").replace("1A04", "1604").replace("TPDO", "RPDO")
    fifth = fifth.replace("0x1C0", "0x240").replace("0x60410010", "0x607A0020")
    path.write_text(eds_text(DriveProfile()) + fifth, encoding="ascii")
    bench = drive_bench(document=Document(read_eds(str(path), NODE), path.read_bytes()))
    bench.operational()
    bench.remote.sdo.download(0x1404, 1, struct.pack("<I", OFF | 0x240 + NODE))
    bench.remote.sdo.download(0x1404, 1, struct.pack("<I", 0x250))
    now_ms = round(bench.scheduler.now_ns / 1e6) + 1
    for step, (can_id, target, found) in enumerate(
        ((0x250, 5, 5), (0x240 + NODE, 6, 5), (0x250, 7, 7))
    ):
        bench.master.send_message(can_id, struct.pack("<i", target))
        bench.sync_at_ms(now_ms + step)
        assert bench.node.image.target_position == found
    bench.set_values(6, 8)
    bench.sync_at_ms(now_ms + 4)
    assert bench.node.image.target_position == 8


@pytest.mark.long
@pytest.mark.parametrize("index", [0x1400, 0x1401, 0x1402, 0x1403, 0x1800, 0x1801, 0x1802, 0x1803])
def test_a_pdo_that_the_file_does_not_have_is_off_and_the_others_stay(
    tmp_path: Path, index: int
) -> None:
    """By bit 31 of its COB-ID (CiA 301, 1400 and 1800), of RPDOs and TPDOs alike."""
    path = tmp_path / "foreign.eds"
    values = []
    text = eds_text(DriveProfile())
    for shown in (text, without(without(text, f"{index:04X}"), f"{index + 0x200:04X}")):
        path.write_text(shown, encoding="ascii")
        values.append(foreign_table(DriveProfile(), read_eds(str(path), NODE)).defaults(NODE))
    whole, less = values
    assert less[index, 1] == whole[index, 1] | OFF
    others = [key for key in whole if key[0] == index and key[1] != 1]
    assert [less[key] for key in others] == [whole[key] for key in others]
    own = {index, index + 0x200}
    assert {key: value for key, value in less.items() if key[0] not in own} == {
        key: value for key, value in whole.items() if key[0] not in own
    }


def test_a_drive_sends_no_telegram_that_its_file_does_not_have(
    drive_bench: Make, tmp_path: Path
) -> None:
    path = tmp_path / "foreign.eds"
    path.write_text(without(eds_text(DriveProfile()), "1800"), encoding="ascii")
    bench = drive_bench(document=Document(read_eds(str(path), NODE), path.read_bytes()))
    bench.operational()
    bench.sync_at_ms(5)
    assert (len(bench.frames(0x183)), len(bench.frames(0x283))) == (0, 1)


def test_the_drive_runs_with_it(bench: Any) -> None:
    bench.operational()
    bench.enable(5)
    word = struct.unpack_from("<H", bench.frames(0x180 + NODE)[-1])[0]
    assert word & 0x6F in (0x23, 0x27)
