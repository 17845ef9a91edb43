"""Archives that attack whoever unpacks them: refused whole, by name, before anything is written."""

import stat
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest

from axisrig.kernel.cosim.fmi import archive
from axisrig.kernel.cosim.fmi.archive import unpack

Pack = Callable[..., Path]
Refused = Callable[[Path], str]


NAMES = [
    ("../outside.txt", "leaves the folder"),
    ("resources/../../outside.txt", "leaves the folder"),
    ("resources/..", "leaves the folder"),
    ("/etc/outside", "absolute path"),
    ("//server/share", "absolute path"),
    ("C:/outside", "drive letter"),
    ("resources/C:outside", "drive letter"),
    ("resources/a.txt:stream", "colon"),
    ("..\\outside.txt", "backslash"),
    ("resources\\inside.txt", "backslash"),
    ("resources/./a", "no plain path"),
    ("resources//a", "no plain path"),
    ("resources/a\nb", "control character"),
    ("resources/a\x7fb", "control character"),
    ("resources/NUL", "device on Windows"),
    ("resources/com1.txt", "device on Windows"),
    ("Aux/a", "device on Windows"),
    ("resources/conin$", "device on Windows"),
    ("resources/a.", "dot or a blank"),
    ("resources /a", "dot or a blank"),
    ("a/" * 30 + "b", "nested deeper"),
    ("a" * 300, "too long for a file"),
    ("ä" * 200, "too long for a file"),
    ("/".join(["b" * 100] * 12), "longer than 1024"),
]


@pytest.mark.parametrize(("name", "reason"), NAMES, ids=[reason for _, reason in NAMES])
def test_a_name_that_leaves_the_folder_or_means_something_else_elsewhere(
    pack: Pack, refused: Refused, name: str, reason: str
) -> None:
    message = refused(pack((name, b"x")))
    assert reason in message
    assert repr(name) in message


def test_a_name_with_a_nul_is_not_cut_there(pack: Pack, refused: Refused) -> None:
    path = pack(("resources/good.txt#.so", b"x"))
    path.write_bytes(path.read_bytes().replace(b"good.txt#", b"good.txt\0"))
    assert "holds a NUL" in refused(path)


def test_an_entry_without_a_name(pack: Pack, refused: Refused) -> None:
    assert "has no name" in refused(pack((zipfile.ZipInfo(""), b"x")))


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        (["resources/a", "resources/a"], "is there twice"),
        (["resources/a", "resources/A"], "one file where case does not count"),
        (["resources/a", "Resources/b"], "one file where case does not count"),
        (["resources/stra\u00dfe", "resources/STRASSE"], "one file where case does not count"),
        (["resources/\u00e9", "resources/e\u0301"], "one file where case does not count"),
        (["resources/\u212b", "resources/\u00c5"], "one file where case does not count"),
        (["resources", "resources/a"], "is inside a file"),
        (["resources/a", "resources"], "is a file and a folder"),
        (["modelDescription.xml"], "is there twice"),
        (["MODELDESCRIPTION.XML"], "one file where case does not count"),
    ],
)
def test_two_entries_for_one_file(
    pack: Pack, refused: Refused, names: Iterable[str], reason: str
) -> None:
    assert reason in refused(pack(*((name, b"x") for name in names)))


def test_a_folder_may_be_named_more_than_once(pack: Pack) -> None:
    folder = unpack(pack(("resources/", b""), ("resources/a", b"x"), ("resources/", b"")))
    assert (folder / "resources" / "a").read_bytes() == b"x"


def _special(mode: int, name: str = "resources/special") -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(name)
    entry.create_system = 3
    entry.external_attr = (mode | 0o777) << 16
    return entry


@pytest.mark.parametrize(
    ("mode", "kind"),
    [
        (stat.S_IFLNK, "a symbolic link"),
        (stat.S_IFIFO, "a named pipe"),
        (stat.S_IFSOCK, "a socket"),
        (stat.S_IFBLK, "a block device"),
        (stat.S_IFCHR, "a character device"),
    ],
)
def test_an_entry_that_is_no_file(pack: Pack, refused: Refused, mode: int, kind: str) -> None:
    message = refused(pack((_special(mode), b"/etc/passwd")))
    assert f"'resources/special' is {kind}" in message


@pytest.mark.parametrize("attribute", [0x400, 0x8])
def test_an_entry_that_is_no_file_on_windows(pack: Pack, refused: Refused, attribute: int) -> None:
    entry = zipfile.ZipInfo("resources/link")
    entry.create_system, entry.external_attr = 0, attribute
    assert "a link or a volume label" in refused(pack((entry, b"x")))


def test_an_entry_that_is_a_folder_by_mode_and_a_file_by_name(pack: Pack, refused: Refused) -> None:
    assert "a file and a folder" in refused(pack((_special(stat.S_IFDIR), b"x")))


def test_a_folder_that_holds_bytes(pack: Pack, refused: Refused) -> None:
    entry = _special(stat.S_IFDIR, "resources/")
    path = pack((entry, b""), ("resources/a", b"xxxx"))
    raw = bytearray(path.read_bytes())
    at = raw.rindex(b"resources/", 0, raw.rindex(b"resources/a")) - 46
    struct.pack_into("<II", raw, at + 20, 4, 4)  # packed and unpacked size in the list
    path.write_bytes(bytes(raw))
    assert "a folder that holds bytes" in refused(path)


def _flagged(path: Path, name: bytes, flags: int) -> Path:
    """Set bits of the general purpose flags of an entry, in its header and in the list."""
    raw = bytearray(path.read_bytes())
    for at in (raw.index(name) - 30 + 6, raw.rindex(name) - 46 + 8):
        (old,) = struct.unpack_from("<H", raw, at)
        struct.pack_into("<H", raw, at, old | flags)
    path.write_bytes(bytes(raw))
    return path


@pytest.mark.parametrize("flags", [0x1, 0x41, 0x2000])
def test_an_encrypted_entry(pack: Pack, refused: Refused, flags: int) -> None:
    path = _flagged(pack(("resources/secret", b"x")), b"resources/secret", flags)
    message = refused(path)
    assert "'resources/secret' is encrypted" in message
    assert "without a password" in message


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_an_entry_packed_by_another_method(pack: Pack, refused: Refused, method: int) -> None:
    entry = zipfile.ZipInfo("resources/a")
    entry.compress_type = method
    assert "other than stored or deflated" in refused(pack((entry, b"x" * 100)))


# ---- Sizes


@pytest.mark.long
def test_a_bomb_that_says_what_it_is(pack: Pack, refused: Refused) -> None:
    message = refused(pack(("resources/zeros", bytes(100 << 20))))
    assert "'resources/zeros' makes an absurd size: 100 MiB unpacked" in message


def _declared(path: Path, name: bytes, size: int) -> Path:
    """Change the unpacked size that header and list declare for an entry."""
    raw = bytearray(path.read_bytes())
    for at in (raw.index(name) - 30 + 22, raw.rindex(name) - 46 + 24):
        struct.pack_into("<I", raw, at, size)
    path.write_bytes(bytes(raw))
    return path


@pytest.mark.parametrize(
    ("declared", "reason"),
    [
        (10, "is damaged (Bad CRC-32"),
        (999, "has other than the 999 bytes that it declares"),
        (1001, "has other than the 1001 bytes that it declares"),
        (5000, "has other than the 5000 bytes that it declares"),
    ],
)
def test_a_size_other_than_the_declared_one(
    pack: Pack, refused: Refused, declared: int, reason: str
) -> None:
    path = _declared(pack(("resources/liar", b"x" * 1000)), b"resources/liar", declared)
    assert f"'resources/liar' {reason}" in refused(path)


def test_more_bytes_than_declared_with_a_fitting_checksum(pack: Pack, refused: Refused) -> None:
    # The checksum of one byte more than declared: all that a reader may ask for to notice
    path = pack(("resources/liar", b"x" * 1000))
    raw = bytearray(_declared(path, b"resources/liar", 10).read_bytes())
    for at in (raw.index(b"resources/liar") - 30 + 14, raw.rindex(b"resources/liar") - 46 + 16):
        struct.pack_into("<I", raw, at, zlib.crc32(b"x" * 11))
    path.write_bytes(bytes(raw))
    assert "'resources/liar' has other than the 10 bytes that it declares" in refused(path)


def test_a_declared_total_beyond_every_disk(pack: Pack, refused: Refused) -> None:
    path = pack(*((f"resources/{i}", b"x" * 50) for i in range(3)))
    for i in range(3):
        _declared(path, f"resources/{i}".encode(), 0xF0000000)
    assert "absurd size: 11520 MiB" in refused(path)


@pytest.mark.parametrize(
    ("declared_mib", "reason"), [(65, "absurd size: 65 MiB"), (63, "has other than the 66060288")]
)
def test_a_ratio_counts_from_64_mib_of_what_is_unpacked_on(
    pack: Pack, refused: Refused, declared_mib: int, reason: str
) -> None:
    """However little it is packed: some 200 bytes here."""
    path = _declared(pack(("resources/a", b"x" * 50)), b"resources/a", declared_mib << 20)
    assert reason in refused(path)


def test_too_many_entries(pack: Pack, refused: Refused, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(archive, "ENTRIES_MAX", 10)
    message = refused(pack(*((f"resources/{i}", b"") for i in range(20))))
    assert "too many entries" in message
    assert "21" in message


def test_a_list_of_entries_that_is_too_long_is_not_even_read(pack: Pack, refused: Refused) -> None:
    path = pack()
    raw = bytearray(path.read_bytes())
    struct.pack_into("<I", raw, raw.rindex(b"PK\5\6") + 12, 0x7FFFFFFF)
    path.write_bytes(bytes(raw))
    assert "too many entries" in refused(path)


@pytest.mark.parametrize("size", [500, 1, 0])
def test_entries_that_share_their_bytes(pack: Pack, refused: Refused, size: int) -> None:
    path = pack(("resources/a", b"a" * size), ("resources/b", b"a" * size))
    raw = bytearray(path.read_bytes())
    first = raw.index(b"resources/a") - 30
    struct.pack_into("<I", raw, raw.rindex(b"resources/b") - 46 + 42, first)
    path.write_bytes(bytes(raw))
    assert "overlaps 'resources/" in refused(path)


def test_a_header_with_another_name_than_the_list(pack: Pack, refused: Refused) -> None:
    path = pack(("resources/good", b"x"))
    path.write_bytes(path.read_bytes().replace(b"resources/good", b"resources/evil", 1))
    assert "resources/good" in refused(path)
