"""Archives that hide entries in others, blow up by many small ones, or are just at a limit."""

import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.fmu_tools.conftest import DESCRIPTION

from axisrig.kernel.cosim.fmi import archive
from axisrig.kernel.cosim.fmi.archive import inspect

Pack = Callable[..., Path]
Refused = Callable[[Path], str]


def hidden(path: Path, before: int) -> Path:
    """The second entry begins so many bytes behind the begin of the first one's content."""
    inner = b"hello"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as packed:
        packed.writestr("modelDescription.xml", DESCRIPTION)
        packed.writestr("resources/b", inner)
    raw = path.read_bytes()
    begin = raw.index(b"resources/b") - 30
    whole = raw[begin : begin + 30 + len("resources/b") + len(inner)]
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as packed:
        packed.writestr("modelDescription.xml", DESCRIPTION)
        packed.writestr("resources/a", b"x" * before + whole + b"x" * 9)
        packed.writestr("resources/b", inner)
    changed = bytearray(path.read_bytes())
    place = changed.index(b"resources/a") + len("resources/a") + before
    assert changed[place : place + 4] == b"PK\3\4"
    struct.pack_into("<I", changed, changed.rindex(b"resources/b") - 46 + 42, place)
    path.write_bytes(bytes(changed))
    return path


@pytest.mark.parametrize("before", [0, 1, 500])
def test_an_entry_inside_the_bytes_of_another_one_is_refused(
    tmp_path: Path, refused: Refused, before: int
) -> None:
    """A small archive could hold itself many times over."""
    path = hidden(tmp_path / "a.fmu", before)
    assert "entry 'resources/b' overlaps 'resources/a'" in refused(path)


def test_the_size_of_an_archive_is_that_of_its_file(pack: Pack) -> None:
    """Packed; what is in it is the sum of its entries."""
    path = pack(("resources/a", bytes(100_000)), ("resources/b", b"b" * 7))
    found = inspect(path)
    assert found.size == path.stat().st_size < 2000
    assert sum(entry.size for entry in found.entries) == 100_007 + len(DESCRIPTION)


@pytest.mark.parametrize("name", ["data", "DATA", "D\u00c4TA", "Da\u0308ta"])
@pytest.mark.parametrize("is_first", [True, False])
def test_a_name_is_a_file_or_a_folder_in_any_spelling(
    pack: Pack, refused: Refused, name: str, is_first: bool
) -> None:
    entries = [(name, b"a"), (f"{name}/inner", b"b")]
    message = refused(pack(*(entries if is_first else entries[::-1])))
    assert ("is inside a file" if is_first else "is a file and a folder") in message


@pytest.mark.parametrize(
    ("count", "size", "is_refused"),
    [(10, 900, True), (1, 9000, True), (10, 50, False), (1, 900, False)],
)
def test_many_small_entries_blow_up_as_much_as_a_large_one(
    pack: Pack, refused: Refused, count: int, size: int, is_refused: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """More than 2000 bytes in all, and more than twice the packed size."""
    monkeypatch.setattr(archive, "RATIO_BYTES_MIN", 2000)
    monkeypatch.setattr(archive, "RATIO_MAX", 2)
    path = pack(*((f"resources/{number}", bytes(size)) for number in range(count)))
    if is_refused:
        assert "makes an absurd size" in refused(path)
    else:
        assert len(inspect(path).entries) == count + 1


@pytest.mark.parametrize("name", archive.XML_FILES)
@pytest.mark.parametrize("more", [-1, 0, 1])
def test_a_document_may_be_as_large_as_the_limit(
    pack: Pack, refused: Refused, name: str, more: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = DESCRIPTION + b"<!--" + b"c" * 600 + b"-->"
    monkeypatch.setattr(archive, "XML_BYTES_MAX", len(text) - more)
    path = pack(description=text) if name == archive.DESCRIPTION else pack((name, text))
    if more > 0:
        assert f"entry {name!r} has" in refused(path)
    else:
        assert name in {entry.name for entry in inspect(path).entries}
