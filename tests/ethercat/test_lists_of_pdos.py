"""Mappings and assignments of a drive at power on, and lists of them that are refused."""

import csv
from importlib import resources

import pytest
from canopen.sdo.exceptions import SdoAbortedError
from tests.ethercat.line import SAFEOP, Line
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


STATUS, PLACE = 0x60410010, 0x60640020
SELDOM = {
    # Values of a drive that few inputs carry: 6062, 6063, 60FC, 6077, 6078
    0x60620020: "position_demand",
    0x60630020: "position_internal",
    0x60FC0020: "position_demand_internal",
    0x60770010: "torque_actual",
    0x60780010: "current_actual",
}


def _with_inputs(line: Line, *entries: int) -> None:
    """Map them in PREOP as the only PDO of the inputs."""
    line.preop()
    writes = [(0x1C13, 0, 0, 1), (0x1A00, 0, 0, 1)]
    writes += [(0x1A00, sub, entry, 4) for sub, entry in enumerate(entries, 1)]
    writes += [(0x1A00, 0, len(entries), 1), (0x1C13, 1, 0x1A00, 2), (0x1C13, 0, 1, 1)]
    for index, sub, value, size in writes:
        assert line.sdo_write(index, sub, value, size) == 0


@pytest.mark.parametrize("entry", SELDOM)
def test_what_the_inputs_carry_is_what_the_drive_has_to_sample(entry: int) -> None:
    """Inputs count, whatever the outputs are."""
    line = Line()
    _with_inputs(line, STATUS, entry)
    data = line.drive.process_data
    assert data.compile() == {"statusword", SELDOM[entry]}
    assert data.inputs.codec.size == 2 + (entry & 0xFF) // 8
    assert "target_position" in data.outputs.fields


def test_an_internal_position_in_the_inputs_is_that_of_each_cycle() -> None:
    """The axis goes 20 mm/s; 6063 is in increments as 6064 is here."""
    line = Line(motion=lambda time_s: 0.02 * time_s)
    _with_inputs(line, PLACE, 0x60630020)
    line.map_image(inputs=8)
    assert line.ask(SAFEOP) == (SAFEOP, 0)
    line.cycle()
    line.write(0x0120, 8, 2)
    found = []
    for _ in range(4):
        data = line.exchange((12, 0, bytes(16)))[0].data
        found.append((int.from_bytes(data[8:12], "little"), int.from_bytes(data[12:], "little")))
        line.wait(2_000_000)
    places = [place for place, _ in found]
    assert places == sorted(set(places))
    assert [inner for _, inner in found] == places


@pytest.mark.parametrize("index", [0x1C12, 0x1C13])
def test_what_was_assigned_before_is_carried_no_more(index: int) -> None:
    """All, none, all again: layouts, values to sample and the message are of the last list."""
    started = Started(outputs=[], inputs=[])
    drive = started.line.drives[0]
    data, store = drive.process_data, drive.objects
    for count in (1, 0, 1):
        store.set_value(index, 0, count)
        carried = data.compile()
        size = data.inputs.codec.size
        assert len(data.message(drive.image)) == size
        assert bool(carried) is (size > 0)
        layout = data.inputs if index == 0x1C13 else data.outputs
        assert bool(layout.codec.size) is bool(count)
        drive.image.target_position = 5
        data.take(drive.image, bytes(data.outputs.codec.size))
        is_taken = "target_position" in data.outputs.fields
        assert drive.image.target_position == (0 if is_taken else 5)
