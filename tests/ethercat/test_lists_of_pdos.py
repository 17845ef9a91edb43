"""Mappings and assignments of a drive at power on, and lists of them that are refused."""

import csv
from importlib import resources

import pytest
from canopen.sdo.exceptions import SdoAbortedError
from tests.ethercat.test_assigned_pdos import CONTROL, TARGET, Started

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore
from axisrig.bench.drive.ethercat.object_access import ObjectAccess
from axisrig.bench.drive.ethercat.objects import described

INCOMPATIBLE = 0x06040043
NOTHING = 0x0005_0008
"""A dummy of 8 bits."""


def _rows() -> dict[tuple[int, int], int]:
    """Defaults of mappings and assignments in the table of the objects."""
    table = resources.files("axisrig.bench.drive.ethercat").joinpath("objects_ethercat.csv")
    return {
        (int(row["index"], 16), int(row["sub"])): int(row["default"], 0)
        for row in csv.DictReader(table.read_text(encoding="utf-8").splitlines())
        if row["sub"] and row["index"] in ("1600", "1601", "1A00", "1A01")
    }


def test_each_pdo_has_the_entries_of_the_table_at_power_on() -> None:
    started, rows = Started(outputs=[], inputs=[]), _rows()
    for index in (0x1600, 0x1601, 0x1A00, 0x1A01):
        count = rows[index, 0]
        assert count > 0
        assert started.listed(index) == [rows[index, sub] for sub in range(1, count + 1)]


def test_a_place_may_be_filled_twice_and_a_pdo_be_assigned_once() -> None:
    line = Started(outputs=[], inputs=[]).line
    for index, size, entries, code in (
        (0x1600, 4, (NOTHING, CONTROL, NOTHING), 0), (0x1C12, 2, (0x1600, 0x1600), INCOMPATIBLE),
    ):  # fmt: skip
        line.sdo_write(index, 0, 0, 1)
        for sub, entry in enumerate(entries, 1):
            assert line.sdo_write(index, sub, entry, size) == 0
        assert line.sdo_write(index, 0, len(entries), 1) == code


def test_a_list_that_is_refused_leaves_the_one_of_before() -> None:
    """Complete access: its number of entries too."""
    drive = Started(outputs=[], inputs=[]).line.drives[0]
    store: ObjectStore = drive.objects
    access = ObjectAccess(store, described(DriveProfile()))
    before = [store.value(0x1600, sub) for sub in range(5)]
    assert before[0] == 3
    for bad in (0x7F00_0010, 0x6041_0010):  # in no dictionary, of a TxPDO
        data = b"\x02\x00" + TARGET.to_bytes(4, "little") + bad.to_bytes(4, "little")
        with pytest.raises(SdoAbortedError):
            access.download(0x1600, 0, data, complete=True)
        assert [store.value(0x1600, sub) for sub in range(5)] == before
    data = b"\x01\x00" + TARGET.to_bytes(4, "little")
    access.download(0x1600, 0, data, complete=True)
    assert [store.value(0x1600, sub) for sub in range(2)] == [1, TARGET]
