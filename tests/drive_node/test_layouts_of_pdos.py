"""What a PDO carries: values of the process image, objects of a maker in memory, and gaps."""

import struct
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.mapping import read_layout
from axisrig.bench.drive.cia402.dictionary.objects import DATA_TYPES

MAPPING = 0x1600
# Each of an own width and sign: type and field of the process image, "" = memory
KINDS = {0x6040: ("U16", "controlword"), 0x607A: ("I32", "target_position"),
         0x6060: ("I8", "mode"), 0x2000: ("I16", ""), 0x2001: ("U32", "")}  # fmt: skip
GAP_1, GAP_4 = 0x0005_0008, 0x0007_0020  # dummies of CiA 301: UNSIGNED8, UNSIGNED32


class Store:
    """Objects by index, and a mapping of these entries."""

    def __init__(self, entries: list[int]) -> None:
        self.values = {(MAPPING, 0): len(entries), (0x2000, 7): 0, (0x2001, 7): 0}
        self.values |= {(MAPPING, sub): entry for sub, entry in enumerate(entries, 1)}

    def value(self, index: int, sub: int = 0) -> int:
        return self.values[index, sub]

    def set_value(self, index: int, sub: int, value: int) -> None:
        self.values[index, sub] = value

    def row(self, index: int, sub: int) -> Any:
        kind, name = KINDS[index]
        return SimpleNamespace(data_type=DATA_TYPES[kind], value=name, key=(index, sub))


def entry(index: int) -> int:
    kind, name = KINDS[index]
    return index << 16 | (0 if name else 7) << 8 | DATA_TYPES[kind].bits


@pytest.mark.parametrize(
    ("entries", "formats"),
    [
        ([0x6040], "H"),
        ([0x607A, 0x6040, 0x6060], "iHb"),
        ([0x2000], "h"),
        ([0x2000, 0x6040, 0x2001], "hHI"),
        ([GAP_1, 0x2001, 0x6060], "xIb"),
        ([GAP_4, 0x607A, GAP_1, 0x2000], "4xixh"),
        ([0x6060, GAP_1, GAP_1, 0x2000, 0x2001], "bxxhI"),
        ([0x2001, GAP_4], "I4x"),
    ],
)
def test_each_entry_has_its_place_among_gaps_and_memory(entries: list[int], formats: str) -> None:
    """Little-endian and without padding, in the order of the mapping (CiA 301)."""
    gaps = (GAP_1, GAP_4)
    store: Any = Store([each if each in gaps else entry(each) for each in entries])
    layout = read_layout(MAPPING, store)
    carried = [index for index in entries if index not in gaps]
    values = {index: -(9 + n) if KINDS[index][0][0] == "I" else 9 + n
              for n, index in enumerate(carried)}  # fmt: skip
    image: Any = SimpleNamespace(controlword=0, target_position=0, mode=0)
    message = struct.pack(f"<{formats}", *values.values())
    layout.store(image, message + b"\xff")  # what comes behind the mapping says nothing
    found = {i: getattr(image, KINDS[i][1]) if KINDS[i][1] else store.value(i, 7) for i in carried}
    assert found == values
    assert layout.codec.size == len(message)
    assert layout.reader()(image) == message
