"""Archives at the limits: sizes of lists and names, forms of zip, order of entries, words."""

import errno
import hashlib
import os
import socket
import stat
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.kernel.cosim.fmi import archive
from axisrig.kernel.cosim.fmi.archive import inspect, unpack
from axisrig.kernel.cosim.fmi.session import session_folder
from axisrig.kernel.errors import UserError

Pack = Callable[..., Path]
Refused = Callable[[Path], str]

END = b"PK\5\6"


def names_in(path: Path) -> list[str]:
    return [entry.name for entry in inspect(path).entries]


# ---- Forms of zip


@pytest.mark.parametrize("length", [0, 1, 1000, 65_535])
def test_a_comment_behind_the_list_of_entries(pack: Pack, length: int) -> None:
    """A zip file may end with up to 65 535 bytes of it (APPNOTE 4.3.16)."""
    path = pack(("resources/a", b"x"))
    with zipfile.ZipFile(path, "a") as packed:
        packed.comment = b"c" * length
    assert names_in(path) == ["modelDescription.xml", "resources/a"]


def large_form(path: Path, count: int | None = None) -> Path:
    """End an archive in the large form: a record of 64 bits, its place, and a full end record.

    count: of entries in the record, where it is not the true one (APPNOTE 4.3.14 to 4.3.16).
    """
    raw = path.read_bytes()
    at = raw.rindex(END)
    _, _, entries, size, offset = struct.unpack_from("<HHHII", raw, at + 6)
    entries = entries if count is None else count
    record = struct.pack(
        "<4sQHHIIQQQQ", b"PK\6\6", 44, 45, 45, 0, 0, entries, entries, size, offset
    )
    place = struct.pack("<4sIQI", b"PK\6\7", 0, at, 1)
    end = struct.pack("<4sHHHHIIH", END, 0, 0, 0xFFFF, 0xFFFF, 0xFFFFFFFF, 0xFFFFFFFF, 0)
    path.write_bytes(raw[:at] + record + place + end)
    return path


def test_the_large_form_of_the_list_counts(pack: Pack) -> None:
    """Its 65 535 entries of the plain form are a place holder."""
    assert names_in(large_form(pack(("resources/a", b"x"))))[1:] == ["resources/a"]


def test_too_many_entries_in_the_large_form(pack: Pack, refused: Refused) -> None:
    message = refused(large_form(pack(("resources/a", b"x")), count=20_001))
    assert "the archive has too many entries; found 20001; allowed: 20000" in message


def test_the_order_of_the_list_need_not_be_that_of_the_bytes(pack: Pack) -> None:
    path = pack(("resources/a", b"a" * 100), ("resources/b", b"b" * 50))
    with zipfile.ZipFile(path, "a") as packed:
        packed.filelist.reverse()
        packed.comment = b"has the list written anew"
    assert names_in(path) == ["resources/b", "resources/a", "modelDescription.xml"]
    assert (unpack(path) / "resources" / "b").read_bytes() == b"b" * 50


def test_of_two_entries_with_the_same_bytes_both_are_named(pack: Pack, refused: Refused) -> None:
    path = pack(("resources/a", b"a" * 500), ("resources/b", b"a" * 500))
    raw = bytearray(path.read_bytes())
    first = raw.index(b"resources/a") - 30
    struct.pack_into("<I", raw, raw.rindex(b"resources/b") - 46 + 42, first)
    path.write_bytes(bytes(raw))
    assert "entry 'resources/b' overlaps 'resources/a'" in refused(path)


# ---- Numbers


@pytest.mark.parametrize(("more", "is_refused"), [(8, False), (9, False), (10, True)])
def test_as_many_entries_as_the_limit_are_taken(
    pack: Pack, refused: Refused, monkeypatch: pytest.MonkeyPatch, more: int, is_refused: bool
) -> None:
    monkeypatch.setattr(archive, "ENTRIES_MAX", 10)
    path = pack(*((f"resources/{number}", b"") for number in range(more)))
    if is_refused:
        assert "too many entries; found 11; allowed: 10" in refused(path)
    else:
        assert len(names_in(path)) == more + 1


def test_a_list_that_is_longer_than_its_count(
    pack: Pack, refused: Refused, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(archive, "ENTRIES_MAX", 10)
    path = pack(*((f"resources/{number}", b"") for number in range(20)))
    raw = bytearray(path.read_bytes())
    struct.pack_into("<HH", raw, raw.rindex(END) + 8, 5, 5)
    path.write_bytes(bytes(raw))
    assert "too many entries; found 21; allowed: 10" in refused(path)


PARTS_OF_100 = ["ä" * 100] * 10  # 1009 characters with the strokes between, 2009 bytes


@pytest.mark.parametrize(
    ("longest", "next_one", "reason"),
    [
        ("/".join(["a"] * 24), "/".join(["a"] * 25), "is nested deeper than 24 folders"),
        ("/".join([*PARTS_OF_100, "b" * 14]), "/".join([*PARTS_OF_100, "b" * 15]),
         "is longer than 1024 characters"),
        ("a" * 255, "a" * 256, "has a name too long for a file"),
        ("ä" * 127 + "b", "ä" * 128, "has a name too long for a file"),
        ("resources/a.b", "resources./a", "ends in a dot or a blank"),
        ("resources/ a", "resources/a ", "ends in a dot or a blank"),
        ("resources/com0x", "resources/Com3.TXT", "is a device on Windows"),
    ],
)  # fmt: skip
def test_the_longest_name_and_the_first_that_is_too_long(
    pack: Pack, refused: Refused, longest: str, next_one: str, reason: str
) -> None:
    assert names_in(pack((longest, b"x")))[1:] == [longest]
    assert f"entry {next_one!r} {reason}" in refused(pack((next_one, b"x")))


def test_the_entry_that_is_largest_when_unpacked_is_named(pack: Pack, refused: Refused) -> None:
    noise = b"".join(hashlib.sha256(bytes([number])).digest() for number in range(100))
    path = pack(("resources/noise", noise), ("resources/a", b"x" * 50))
    raw = bytearray(path.read_bytes())
    for at in (raw.index(b"resources/a") - 30 + 22, raw.rindex(b"resources/a") - 46 + 24):
        struct.pack_into("<I", raw, at, 65 << 20)
    path.write_bytes(bytes(raw))
    assert "entry 'resources/a' makes an absurd size: 65 MiB unpacked" in refused(path)


# ---- Words


def test_both_spellings_of_one_file_are_named(pack: Pack, refused: Refused) -> None:
    path = pack(("resources/Table.csv", b"x"), ("resources/TABLE.csv", b"x"))
    wanted = "entry 'resources/TABLE.csv' and 'resources/Table.csv' are one file"
    assert wanted in refused(path)


@pytest.mark.parametrize(
    ("name", "is_in_a_folder"),
    [("old_modelDescription.xml", False), ("M/modelDescription.xml", True)],
)
def test_the_hint_at_the_folder_is_for_a_packed_folder_alone(
    pack: Pack, refused: Refused, name: str, is_in_a_folder: bool
) -> None:
    message = refused(pack((name, b"<a/>"), description=None))
    assert f"found {name!r}" in message or f"found '{name}'" in message
    assert ("pack the content of the folder" in message) is is_in_a_folder


def test_an_archive_without_any_entry(pack: Pack, refused: Refused) -> None:
    message = refused(pack(description=None))
    assert "found 'an empty archive'" in message
    assert "pack the content" not in message


def test_a_folder_by_its_name_that_is_a_file_by_its_mode(pack: Pack, refused: Refused) -> None:
    entry = zipfile.ZipInfo("resources/")
    entry.create_system, entry.external_attr = 3, (stat.S_IFREG | 0o644) << 16
    assert "entry 'resources/' is marked as a file and a folder" in refused(pack((entry, b"")))


@pytest.mark.skipif(not hasattr(socket, "AF_UNIX"), reason="no such files on this system")
def test_a_file_that_cannot_be_opened_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # the name of a socket is at most some 100 bytes long
    with socket.socket(socket.AF_UNIX) as made:
        made.bind("odd.fmu")
        with pytest.raises(UserError, match="the FMU cannot be read") as caught:
            unpack(tmp_path / "odd.fmu")
    assert caught.value.hint == os.strerror(errno.ENXIO)


def test_a_full_disk_leaves_nothing_behind(pack: Pack, monkeypatch: pytest.MonkeyPatch) -> None:
    def write(_path: Path, _archive: zipfile.ZipFile, folder: Path) -> None:
        (folder / "half").write_bytes(b"x")
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(archive, "_write", write)
    with pytest.raises(UserError, match="cannot be unpacked into") as caught:
        unpack(pack(("resources/a", b"of a disk that is full")))
    assert os.strerror(errno.ENOSPC) in caught.value.message
    assert [place.name for place in session_folder().iterdir() if "building" in place.name] == []
