"""Forms of zip that are refused or taken for what they are, and which content a path stands for."""

import os
import struct
import zipfile
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest
from tests.fmu_tools.conftest import DESCRIPTION
from tests.fmu_tools.test_limits_of_archives import large_form

from axisrig.kernel.cosim.fmi import archive
from axisrig.kernel.cosim.fmi.archive import inspect, unpack
from axisrig.kernel.errors import UserError

Pack = Callable[..., Path]
Refused = Callable[[Path], str]


def of_entry(path: Path, name: bytes, local: int, listed: int, form: str, *values: int) -> None:
    """Change a field of an entry, in its own head and in the list (APPNOTE 4.3.7 and 4.3.12)."""
    raw = bytearray(path.read_bytes())
    struct.pack_into(form, raw, raw.index(name) - 30 + local, *values)
    struct.pack_into(form, raw, raw.rindex(name) - 46 + listed, *values)
    path.write_bytes(bytes(raw))


@pytest.mark.parametrize(
    ("flag", "reason"),
    [
        (0x1, "is encrypted"), (0x40, "is encrypted"), (0x2000, "is encrypted"),
        (0x41, "is encrypted"), (0x20, "is packed by a method other than stored or deflated"),
    ],
)  # fmt: skip
def test_each_flag_of_an_entry_that_cannot_be_read_says_why(
    pack: Pack, refused: Refused, flag: int, reason: str
) -> None:
    """APPNOTE 4.4.4: bits 0, 5, 6 and 13."""
    path = pack(("resources/a", b"x"))
    of_entry(path, b"resources/a", 6, 8, "<H", flag)
    assert f"entry 'resources/a' {reason}" in refused(path)


@pytest.mark.parametrize("flag", [0x2, 0x4, 0x800])
def test_flags_of_how_an_entry_was_packed_refuse_nothing(pack: Pack, flag: int) -> None:
    """Options of deflate, and names in UTF-8."""
    path = pack(("resources/a", b"x" * 50))
    of_entry(path, b"resources/a", 6, 8, "<H", flag)
    assert (unpack(path) / "resources" / "a").read_bytes() == b"x" * 50


def test_the_entries_of_all_disks_count_in_the_large_form(pack: Pack, refused: Refused) -> None:
    """APPNOTE 4.3.14: first those of this disk, then all of them."""
    path = large_form(pack(("resources/a", b"x")))
    raw = bytearray(path.read_bytes())
    at = raw.rindex(b"PK\6\6")
    assert struct.unpack_from("<QQ", raw, at + 24) == (2, 2)
    struct.pack_into("<Q", raw, at + 32, 20_001)
    path.write_bytes(bytes(raw))
    assert "the archive has too many entries; found 20001; allowed: 20000" in refused(path)


def test_an_entry_that_ends_behind_the_end_of_its_file_is_damage_with_a_name(
    tmp_path: Path, refused: Refused
) -> None:
    """The exception has no text of its own: its type is shown."""
    path = tmp_path / "short.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as packed:
        packed.writestr("modelDescription.xml", DESCRIPTION)
        packed.writestr("resources/a", b"x")
    of_entry(path, b"resources/a", 18, 20, "<II", 5000, 5000)
    assert "the FMU is damaged: EOFError" in refused(path)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("resources/\u03b1\u0345\u0301", "resources/\u1fb4"),  # alpha, iota below, acute
        ("resources/\u1fb4", "resources/\u03b1\u0301\u0345"),
        ("resources/e\u0301", "resources/\u00c9"),
    ],
)
def test_names_that_one_system_takes_for_the_same_are_one_file(
    pack: Pack, refused: Refused, one: str, other: str
) -> None:
    """Unicode, canonical equivalence: the order of marks does not make another name."""
    message = refused(pack((one, b"x"), (other, b"y")))
    assert f"entry {other!r} and {one!r} are one file where case does not count" in message


@pytest.mark.parametrize(
    "names",
    [
        ("resources/ab", "resources/a"), ("resources/a", "resources/ab"),
        ("data2/x", "data"), ("data.d/x", "data"), ("DATA2/x", "data"),
    ],
)  # fmt: skip
def test_a_name_that_begins_another_one_is_a_file_of_its_own(
    pack: Pack, names: tuple[str, str]
) -> None:
    path = pack(*((name, name.encode()) for name in names))
    assert [entry.name for entry in inspect(path).entries][1:] == list(names)
    for name in names:
        assert (unpack(path) / name).read_bytes() == name.encode()


@pytest.mark.parametrize(("more", "is_refused"), [(-1, False), (0, False), (1, True)])
def test_an_archive_may_unpack_to_just_the_ratio(
    pack: Pack, refused: Refused, monkeypatch: pytest.MonkeyPatch, more: int, is_refused: bool
) -> None:
    path = pack(("resources/a", bytes(5000)))
    total = 5000 + len(DESCRIPTION)
    monkeypatch.setattr(archive, "RATIO_BYTES_MIN", 0)
    monkeypatch.setattr(archive, "RATIO_MAX", Fraction(total - more, path.stat().st_size))
    if is_refused:
        assert "entry 'resources/a' makes an absurd size" in refused(path)
    else:
        assert len(inspect(path).entries) == 2


@pytest.mark.parametrize("bytes_min", [5000 + len(DESCRIPTION) - 1, 5000 + len(DESCRIPTION)])
def test_what_is_small_may_have_any_ratio(
    pack: Pack, refused: Refused, monkeypatch: pytest.MonkeyPatch, bytes_min: int
) -> None:
    path = pack(("resources/a", bytes(5000)))
    monkeypatch.setattr(archive, "RATIO_BYTES_MIN", bytes_min)
    monkeypatch.setattr(archive, "RATIO_MAX", 1)
    if bytes_min < 5000 + len(DESCRIPTION):
        assert "makes an absurd size" in refused(path)
    else:
        assert len(inspect(path).entries) == 2


# ---- Which content a path stands for


@pytest.mark.parametrize("what", ["size", "time", "file"])
def test_a_file_that_is_written_again_is_unpacked_again(pack: Pack, what: str) -> None:
    """Another size, another time or another file under the same name: one of them is enough."""
    path = pack(("resources/a", b"first 1"))
    before = path.stat()
    assert (unpack(path) / "resources" / "a").read_bytes() == b"first 1"
    kept = path.with_name("kept.fmu")
    if what == "file":
        path.rename(kept)
    content = b"second and longer" if what == "size" else b"first 2"
    pack(("resources/a", content))
    later = 2_000_000_000 if what == "time" else 0
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns + later))
    now = path.stat()
    assert [
        now.st_size != before.st_size,
        now.st_mtime_ns != before.st_mtime_ns,
        now.st_ino != before.st_ino,
    ] == [what == "size", what == "time", what == "file"]
    assert (unpack(path) / "resources" / "a").read_bytes() == content


def test_a_folder_that_another_process_has_made_meanwhile_is_taken(
    pack: Pack, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = pack(("resources/a", b"of two processes at once"))
    sha256 = inspect(path).sha256
    made: list[Path] = []

    def write(_path: Path, _archive: zipfile.ZipFile, folder: Path) -> None:
        (folder / "mine").write_bytes(b"x")
        other = folder.parent / sha256
        other.mkdir()
        (other / "theirs").write_bytes(b"x")
        made.append(folder)

    monkeypatch.setattr(archive, "_write", write)
    target = unpack(path)
    assert target.name == sha256
    assert [place.name for place in target.iterdir()] == ["theirs"]
    assert not made[0].exists()


def test_an_fmu_that_is_not_there_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="FMU not found") as caught:
        unpack(tmp_path / "none.fmu")
    assert caught.value.file == str(tmp_path / "none.fmu")
