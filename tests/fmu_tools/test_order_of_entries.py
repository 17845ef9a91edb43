"""An archive may list its entries in any order; what counts is where their bytes are."""

import struct
import warnings
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from axisrig.kernel.cosim.fmi.archive import DESCRIPTION, inspect, unpack

NAMES = (DESCRIPTION, "resources/a", "resources/ä/b", "sources/c")
Refused = Callable[[Path], str]


def listed(folder: Path, order: Sequence[int], *, method: int = zipfile.ZIP_DEFLATED) -> Path:
    """An archive whose bytes are in the order of NAMES and whose list is in another one."""
    path = folder / f"{''.join(map(str, order))}.fmu"
    with zipfile.ZipFile(path, "w", method) as packed, warnings.catch_warnings():
        for number, name in enumerate(NAMES):
            content = b"<fmiModelDescription/>" if name == DESCRIPTION else name.encode() * number
            packed.writestr(name, content)
        packed.filelist[:] = [packed.filelist[place] for place in order]
    return path


@pytest.mark.parametrize("method", [zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED])
@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 2, 1, 0), (1, 0, 3, 2), (2, 3, 0, 1)])
def test_a_list_in_another_order_than_the_bytes_is_sound(
    tmp_path: Path, order: tuple[int, ...], method: int
) -> None:
    """As tools write it that sort their list, or put the description last."""
    path = listed(tmp_path, order, method=method)
    assert [entry.name for entry in inspect(path).entries] == [NAMES[place] for place in order]
    folder = unpack(path)
    for number, name in enumerate(NAMES[1:], 1):
        assert (folder / name).read_bytes() == name.encode() * number


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 2, 1, 0), (3, 0, 2, 1)])
def test_two_entries_with_the_same_bytes_are_found_in_any_order(
    tmp_path: Path, refused: Refused, order: tuple[int, ...]
) -> None:
    """The last entry of the list of bytes is given the place of the one before the last."""
    path = listed(tmp_path, order)
    raw = bytearray(path.read_bytes())
    first, last = (raw.index(NAMES[place].encode()) - 30 for place in (2, 3))
    assert last > first
    struct.pack_into("<I", raw, raw.rindex(NAMES[3].encode()) - 46 + 42, first)
    path.write_bytes(bytes(raw))
    assert "overlaps 'resources/" in refused(path) or "overlaps 'sources/" in refused(path)
