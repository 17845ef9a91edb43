"""Which limits, defaults and mappings a drive takes from the EDS of its maker, object by object."""

from pathlib import Path
from typing import Any

import pytest
from canopen.objectdictionary import ObjectDictionary, ODRecord, ODVariable, datatypes
from tests.drive_node.test_drive_by_eds import foreign
from tests.eds_changes import changed

from axisrig.bench.drive.canopen.node import Document
from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.foreign import foreign_table
from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.kernel.drives.canopen.dictionary import read_eds

NODE = 3
NOTHING = 0x0005_0008
"""A dummy of 8 bits (CiA 301: an object that fills a place of an RPDO)."""


@pytest.mark.parametrize(
    ("low", "high", "kept"),
    [
        (-100, 100, (-100, 100)), (None, 100, (None, 100)), (-100, None, (-100, None)),
        # Place holders of editors: one value alone is no range
        (0, 0, (None, None)), (7, 7, (None, None)), (None, None, (None, None)), (0, 1, (0, 1)),
    ],
)  # fmt: skip
def test_limits_are_those_of_the_file_where_they_are_a_range(
    low: int | None, high: int | None, kept: tuple[int | None, int | None]
) -> None:
    """Of an object of the maker; one of the model has its own where the file has none."""
    own = variables()[0x60C2, 2]
    assert None not in (own.low, own.high)
    od: Any = ObjectDictionary()
    for index, sub in ((0x2000, 0), (0x60C2, 2)):
        one: Any = ODVariable(f"{index:X}", index, sub)
        one.data_type, one.access_type, one.min, one.max = datatypes.INTEGER16, "rw", low, high
        if sub:
            od.add_object(ODRecord(f"{index:X}", index))
            od[index].add_member(one)
        else:
            od.add_object(one)
    rows = foreign_table(DriveProfile(), od).rows
    assert (rows[0x2000, 0].low, rows[0x2000, 0].high) == kept
    expected = tuple(
        usual if limit is None else limit
        for limit, usual in zip(kept, (own.low, own.high), strict=True)
    )
    assert (rows[0x60C2, 2].low, rows[0x60C2, 2].high) == expected


@pytest.mark.parametrize(
    ("kind", "low", "high"),
    [
        (datatypes.UNSIGNED8, 0, 255), (datatypes.INTEGER8, -128, 127),
        (datatypes.UNSIGNED16, 0, 65_535), (datatypes.INTEGER32, -(2**31), 2**31 - 1),
        (datatypes.UNSIGNED64, 0, 2**64 - 1),
    ],
)  # fmt: skip
def test_a_default_that_its_type_cannot_hold_is_0(kind: int, low: int, high: int) -> None:
    od: Any = ObjectDictionary()
    one: Any = ODVariable("own", 0x2000)
    one.data_type, one.access_type = kind, "rw"
    od.add_object(one)
    table = foreign_table(DriveProfile(), od)
    for value, begins in ((low, low), (high, high), (low - 1, 0), (high + 1, 0), (1, 1)):
        one.default = value
        assert table.defaults(NODE)[0x2000, 0] == begins


@pytest.mark.long
@pytest.mark.parametrize(("mapping", "count"), [(0x1600, 1), (0x1A00, 0)])
def test_a_dummy_fills_a_place_of_an_rpdo_alone(tmp_path: Path, mapping: int, count: int) -> None:
    path, text = tmp_path / "foreign.eds", foreign()
    text = changed(text, f"{mapping:X}sub0", DefaultValue="1")
    text = changed(text, f"{mapping:X}sub1", DefaultValue=f"0x{NOTHING:08X}")
    path.write_text(text, encoding="ascii")
    values = foreign_table(DriveProfile(), read_eds(str(path), NODE)).defaults(NODE)
    assert values[mapping, 0] == count


@pytest.mark.parametrize(("value", "begins"), [(6, 6), (5, 2)])
def test_a_value_that_the_drive_would_refuse_is_not_its_value_at_power_on(
    drive_bench: Any, tmp_path: Path, value: int, begins: int
) -> None:
    """605A of a drive that takes 2 and 6 alone; another object of the file is as it says."""
    path = tmp_path / "foreign.eds"
    path.write_text(changed(foreign(), "605A", DefaultValue=f"{value}"), encoding="ascii")
    document = Document(read_eds(str(path), NODE), path.read_bytes())
    bench = drive_bench(profile=DriveProfile(option_codes="605A:2,6"), document=document)
    image = bench.node.servo.image
    assert (image.quick_stop_option, image.following_window) == (begins, 4711)


@pytest.mark.parametrize(("lacks", "count"), [("", 2), ("60D0.2", 1), ("60D0.1", 1)])
def test_60d0_has_as_many_sources_as_the_drive(lacks: str, count: int) -> None:
    sources: Any = object_dictionary(NODE, DriveProfile(lacks=lacks))[0x60D0]
    assert sources[0].default == count
    assert len(sources.subindices) == 1 + count
