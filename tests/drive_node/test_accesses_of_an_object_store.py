"""Objects of a device by hand: rights, limits and lengths of an access, and what is stored."""

from types import SimpleNamespace
from typing import Any

import pytest
from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.cia402.dictionary.mapping import parts_of
from axisrig.bench.drive.cia402.dictionary.objects import DATA_TYPES
from axisrig.bench.drive.cia402.dictionary.storage import SAVE, ParameterStorage
from axisrig.bench.drive.cia402.dictionary.store import ObjectStore

WRITE_ONLY, READ_ONLY, NO_OBJECT, NO_SUB_INDEX = 0x06010001, 0x06010002, 0x06020000, 0x06090011
TOO_LONG, TOO_SHORT, TOO_HIGH, TOO_LOW = 0x06070012, 0x06070013, 0x06090031, 0x06090032
TEXT = SimpleNamespace(bits=0)


def row(index: int, sub: int = 0, kind: str = "I16", **members: Any) -> Any:
    usual = {"access": "rw", "pdo": "", "low": None, "high": None, "value": ""}
    members = usual | {"allowed": range(-(2**31), 2**32)} | members
    data_type = DATA_TYPES.get(kind, TEXT)
    return SimpleNamespace(index=index, sub=sub, key=(index, sub), data_type=data_type, **members)


def store_of(*rows: Any, default: Any = 5, absent: tuple[Any, ...] = (), image: Any = None) -> Any:
    """A store with these objects at their default; those that are absent have rows only."""
    table: Any = SimpleNamespace(
        rows={one.key: one for one in rows},
        signed={one.key: one.data_type.bits == 16 for one in rows},
        indices=frozenset(one.index for one in rows),
        defaults=lambda node_id: {one.key: default for one in rows},
        has=lambda index, sub: (index, sub) not in absent,
    )
    store = ObjectStore(table, image or SimpleNamespace(), lambda row: None)
    store.restore(3, 0, 0xFFFF)
    return store


def code_of(call: Any, *arguments: Any) -> int:
    """The abort code of an access, 0 where it is taken."""
    try:
        call(*arguments)
    except SdoAbortedError as error:
        return int(error.code)
    return 0


@pytest.mark.parametrize(
    ("access", "read", "written"),
    [("rw", 0, 0), ("wo", WRITE_ONLY, 0), ("ro", 0, READ_ONLY), ("const", 0, READ_ONLY)],
)
def test_an_object_is_read_and_written_as_its_access_says(
    access: str, read: int, written: int
) -> None:
    store = store_of(row(0x2000, access=access))
    assert code_of(store.upload, 0x2000, 0) == read
    assert code_of(store.writable_size, 0x2000, 0) == written
    assert code_of(store.download, 0x2000, 0, b"\x07\x00") == written
    assert store.value(0x2000) == (5 if written else 7)


@pytest.mark.parametrize(
    ("value", "code"), [(-4, TOO_LOW), (-3, 0), (0, 0), (9, 0), (10, TOO_HIGH), (-9, TOO_LOW)]
)
def test_both_limits_of_an_object_are_values_that_it_takes(value: int, code: int) -> None:
    store = store_of(row(0x2000, low=-3, high=9))
    assert code_of(store.download, 0x2000, 0, value.to_bytes(2, "little", signed=True)) == code
    assert store.value(0x2000) == (5 if code else value)


@pytest.mark.parametrize(("size", "code"), [(1, TOO_SHORT), (2, 0), (3, TOO_LONG), (0, TOO_SHORT)])
def test_a_number_has_the_bytes_of_its_type(size: int, code: int) -> None:
    store = store_of(row(0x2000))
    assert code_of(store.download, 0x2000, 0, bytes(size)) == code
    assert store.value(0x2000) == (5 if code else 0)


@pytest.mark.parametrize(("size", "code"), [(0, 0), (65_536, 0), (65_537, TOO_LONG)])
def test_a_text_has_up_to_65536_bytes(size: int, code: int) -> None:
    store = store_of(row(0x2000, kind="TEXT"), default=b"old")
    assert store.writable_size(0x2000, 0) is None
    assert code_of(store.download, 0x2000, 0, b"x" * size) == code
    assert store.upload(0x2000, 0) == (b"old" if code else b"x" * size)


def test_an_object_that_the_device_lacks_is_not_found() -> None:
    """One sub-index of two, or an index that is nowhere."""
    store = store_of(row(0x2000, 1), row(0x2000, 2), absent=((0x2000, 2),))
    assert [one.key for one in store.rows] == [(0x2000, 1)]
    for access in (store.row, store.upload, store.writable_size):
        assert code_of(access, 0x2000, 1) == 0
        assert code_of(access, 0x2000, 2) == NO_SUB_INDEX
        assert code_of(access, 0x2001, 0) == NO_OBJECT


@pytest.mark.parametrize(
    ("index", "access", "value"),
    [(0x1005, "rw", 5), (0x1FFF, "rw", 5), (0x1001, "ro", 77), (0x2000, "rw", 77),
     (0x6041, "ro", 77)],
)  # fmt: skip
def test_a_restore_gives_the_image_what_a_master_has_set_for_the_bus(
    index: int, access: str, value: int
) -> None:
    """Of 1000 to 1FFF what can be written; the rest of the image is of the application."""
    image = SimpleNamespace(member=77)
    store = store_of(row(index, access=access, value="member"), image=image)
    assert (image.member, store.value(index)) == (value, value)


@pytest.mark.parametrize(
    ("group", "inside"),
    [(1, {0x1000, 0x1FFF, 0x2000, 0x5FFF, 0x6000, 0x9FFF, 0xA000, 0xFFFF}),
     (2, {0x1000, 0x1FFF}), (3, {0x6000, 0x9FFF})],
)  # fmt: skip
def test_a_group_is_stored_and_forgotten_from_its_first_object_to_its_last(
    group: int, inside: set[int]
) -> None:
    """CiA 301, 1010: all, communication 1000 to 1FFF, application 6000 to 9FFF."""
    indices = (0x1000, 0x1FFF, 0x2000, 0x5FFF, 0x6000, 0x9FFF, 0xA000, 0xFFFF)
    store = store_of(*(row(index) for index in indices))
    storage = ParameterStorage(store)
    for index in indices:
        store.set_value(index, 0, 9)
    storage.written(0x1010, group, SAVE)
    assert {index for index, _ in storage.stored} == inside
    storage.written(0x1010, 1, SAVE)
    assert {index for index, _ in storage.stored} == set(indices)
    storage.written(0x1011, group, 0)
    assert {index for index, _ in storage.stored} == set(indices) - inside


def test_a_value_that_is_stored_anew_takes_the_place_of_the_one_before() -> None:
    """9, then its default of 5, then 7: after a reset each time what was stored last."""
    store = store_of(row(0x6000), row(0x6001))
    storage = ParameterStorage(store)
    for value in (9, 5, 7):
        store.set_value(0x6000, 0, value)
        storage.written(0x1010, 3, SAVE)
        store.restore(3, 0x6000, 0x9FFF)
        storage.apply(3, 0x6000, 0x9FFF)
        assert (store.value(0x6000), store.value(0x6001)) == (value, 5)


@pytest.mark.parametrize(("first", "last"), [(0x1000, 0x1FFF), (0x1FFF, 0x6000), (0x6000, 0x6000)])
def test_what_was_stored_comes_back_from_the_first_object_to_the_last(
    first: int, last: int
) -> None:
    indices = (0x1000, 0x1FFF, 0x6000, 0x9FFF)
    store = store_of(*(row(index) for index in indices))
    storage = ParameterStorage(store)
    storage.load({(index, 0): 9 for index in indices})
    storage.apply(3, first, last)
    found = {index for index in indices if store.value(index) == 9}
    assert found == {index for index in indices if first <= index <= last}


@pytest.mark.parametrize(
    ("entry", "parts"),
    [(0x6040_0010, (0x6040, 0, 16)), (0xFFFF_FFFF, (0xFFFF, 255, 255)),
     (0x2001_8040, (0x2001, 128, 64)), (0x0005_0008, (5, 0, 8))],
)  # fmt: skip
def test_an_entry_has_16_bits_of_index_8_of_sub_index_and_8_of_length(
    entry: int, parts: tuple[int, int, int]
) -> None:
    assert parts_of(entry) == parts
