"""Unpacks FMUs: foreign archives, of which every entry is judged before anything is written.

An FMU is a zip archive from anywhere. What could write outside its folder, fill the disk or mean
two things on two systems is refused whole, with the name of the entry. What is accepted is unpacked
once per content into a folder that only this user can read and that goes when the process ends.
Source: APPNOTE.TXT 6.3 (zip); FMI 3.0 section 2.5 (structure of the archive).
"""

import copy
import hashlib
import os
import re
import shutil
import stat
import struct
import tempfile
import unicodedata
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from io import BufferedReader
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from axisrig.kernel.cosim.fmi.session import session_folder
from axisrig.kernel.errors import UserError, why_unread

DESCRIPTION = "modelDescription.xml"
# Read with an XML parser later; checked for entities and depth here
XML_FILES = (DESCRIPTION, "sources/buildDescription.xml", "terminalsAndIcons/terminalsAndIcons.xml")

MIB = 1 << 20
TOTAL_BYTES_MAX = 4096 * MIB  # unpacked; the largest FMUs of tool vendors hold some 500 MiB
ENTRIES_MAX = 20_000
DIRECTORY_BYTES_MAX = 32 * MIB  # of the list of entries, which is read as a whole
XML_BYTES_MAX = 128 * MIB
XML_DEPTH_MAX = 200  # libxml2 stops at 256
# Deflate cannot do better than 1032; what comes near it holds nothing but repetitions
RATIO_MAX, RATIO_BYTES_MIN = 200, 64 * MIB
PATH_DEPTH_MAX, PATH_LENGTH_MAX, NAME_BYTES_MAX = 24, 1024, 255
CHUNK = 1 * MIB

_ENCRYPTED, _PATCHED, _STRONG, _MASKED = 0x1, 0x20, 0x40, 0x2000
_DOS_VOLUME, _NT_REPARSE_POINT = 0x8, 0x400
_KINDS = {
    stat.S_IFLNK: "a symbolic link",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFBLK: "a block device",
    stat.S_IFCHR: "a character device",
}
_WINDOWS_DEVICE = re.compile(r"(con|prn|aux|nul|conin\$|conout\$|(com|lpt)[0-9¹²³])(\..*)?")


@dataclass(frozen=True)
class Entry:
    """One entry of an archive. name: with `/`. size: unpacked, bytes."""

    name: str
    size: int
    is_folder: bool


@dataclass(frozen=True)
class Archive:
    """An archive that was found safe. sha256: of its bytes; size: packed, bytes."""

    path: Path
    sha256: str
    size: int
    entries: tuple[Entry, ...]


def inspect(path: Path) -> Archive:
    """Judge an archive without writing anything.

    Raises UserError for whatever is not safe, or is no FMU, with the entry that is to blame.
    """
    with _opened(path) as (file, archive):
        _check(path, file, archive)
        return Archive(path, _sha256(file), path.stat().st_size, tuple(_entries(archive)))


def unpack(path: Path) -> Path:
    """Return a private folder with the content of the FMU at `path`, unpacked once per content.

    Raises UserError as `inspect` does, before anything is written.
    """
    if not path.exists():
        raise UserError("FMU not found", file=path)
    stamp = path.stat()
    return _unpacked(path.resolve(), (stamp.st_mtime_ns, stamp.st_size, stamp.st_ino))


@cache
def _unpacked(path: Path, _stamp: tuple[int, int, int]) -> Path:
    with _opened(path) as (file, archive):
        target = session_folder() / _sha256(file)
        if target.is_dir():
            return target
        _check(path, file, archive)
        # Renamed when complete, so that no other process finds half of it
        building = Path(tempfile.mkdtemp(prefix="building-", dir=session_folder()))
        try:
            _write(path, archive, building)
            building.rename(target)
        except OSError as error:
            shutil.rmtree(building, ignore_errors=True)
            if not target.is_dir():
                raise UserError(
                    f"the FMU cannot be unpacked into {building.parent}: {error.strerror}",
                    file=path,
                ) from error
        return target


_BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    EOFError,
    ValueError,
    NotImplementedError,
    RuntimeError,
    OverflowError,
)
REPACK = "ask its maker to pack it again"
NO_FMU = "this is no FMU (a zip archive with modelDescription.xml)"


@contextmanager
def _opened(path: Path) -> Iterator[tuple[BufferedReader, zipfile.ZipFile]]:
    """Open the archive once, so that what is judged is what is unpacked."""
    if path.is_dir():
        raise UserError("this is a folder, not an FMU file", file=path)
    try:
        file = path.open("rb")
    except OSError as error:
        hint = why_unread(path, error)
        raise UserError("the FMU cannot be read", file=path, hint=hint) from error
    with file:
        try:
            _check_directory_size(path, file)
            with zipfile.ZipFile(file) as archive:
                yield file, archive
        except _BROKEN as error:
            detail = str(error).partition("\n")[0] or type(error).__name__
            raise UserError(
                f"the FMU is damaged: {detail}", file=path, hint="copy or export it again"
            ) from error


def _check_directory_size(path: Path, file: BufferedReader) -> None:
    """Refuse a list of entries too long to be read, before it is read."""
    end = file.seek(0, os.SEEK_END)
    if end == 0:
        raise UserError(f"{NO_FMU}: the file is empty", file=path)
    start = max(0, end - 65_557)  # the end record with the longest comment
    file.seek(start)
    tail = file.read()
    at = tail.rfind(b"PK\5\6")
    if at < 0 or len(tail) - at < 22:
        raise UserError(NO_FMU, file=path)
    _, _, count, size = struct.unpack_from("<HHHI", tail, at + 6)
    if at >= 20 and tail[at - 20 : at - 16] == b"PK\6\7":  # large form, which then counts
        (offset,) = struct.unpack_from("<Q", tail, at - 12)
        file.seek(min(offset, end))
        record = file.read(56)
        if len(record) == 56 and record[:4] == b"PK\6\6":
            _, count, size = struct.unpack_from("<QQQ", record, 24)
    file.seek(0)
    if count > ENTRIES_MAX or (size > DIRECTORY_BYTES_MAX and size != 0xFFFFFFFF):
        raise UserError(
            "the archive has too many entries", file=path, value=count, allowed=f"{ENTRIES_MAX}"
        )


def _refuse(
    path: Path, name: str, why: str, *, allowed: str | None = None, hint: str | None = None
) -> NoReturn:
    raise UserError(
        f"unsafe archive: entry {name!r} {why}", file=path, allowed=allowed, hint=hint or REPACK
    )


def _check(path: Path, file: BufferedReader, archive: zipfile.ZipFile) -> None:
    """Judge the names, then the kinds, the sizes and, last, the bytes of all entries."""
    entries = archive.infolist()
    if len(entries) > ENTRIES_MAX:
        raise UserError(
            "the archive has too many entries",
            file=path,
            value=len(entries),
            allowed=f"{ENTRIES_MAX}",
        )
    _check_names(path, entries)
    for entry in entries:
        _check_kind(path, entry)
    _check_sizes(path, file, entries)
    _check_places(path, entries)
    for entry in entries:
        _check_content(path, archive, entry)


def _check_names(path: Path, entries: list[zipfile.ZipInfo]) -> None:
    spellings: dict[str, str] = {}
    files: set[str] = set()
    for entry in entries:
        name = entry.orig_filename
        if reason := _bad_name(name):
            _refuse(path, name, reason)
        parts = name.rstrip("/").split("/")
        for depth in range(1, len(parts) + 1):
            spelling = "/".join(parts[:depth])
            key = unicodedata.normalize("NFC", unicodedata.normalize("NFC", spelling).casefold())
            if spellings.setdefault(key, spelling) != spelling:
                other = spellings[key]
                _refuse(path, name, f"and {other!r} are one file where case does not count")
            if key in files:
                is_same = depth == len(parts)
                _refuse(path, name, "is there twice" if is_same else "is inside a file")
        if not name.endswith("/"):
            if any(other.startswith(f"{key}/") for other in spellings):
                _refuse(path, name, "is a file and a folder")
            files.add(key)
    if DESCRIPTION not in (entry.orig_filename for entry in entries):
        inner = next(
            (e.orig_filename for e in entries if e.orig_filename.endswith(DESCRIPTION)), ""
        )
        raise UserError(
            NO_FMU,
            file=path,
            value=inner or ("an empty archive" if not entries else None),
            hint="pack the content of the folder, not the folder" if "/" in inner else None,
        )


def _bad_name(name: str) -> str | None:
    """Say what is wrong with the name of an entry on any system, None when nothing is."""
    parts = (name[:-1] if name.endswith("/") else name).split("/")
    checks = (
        (name == "", "has no name"),
        ("\0" in name, "holds a NUL"),
        (any(unicodedata.category(sign) == "Cc" for sign in name), "holds a control character"),
        (name.startswith("/"), "is an absolute path"),
        ("\\" in name, "holds a backslash"),
        (":" in name, "holds a drive letter or a colon"),
        (".." in parts, "leaves the folder of the FMU"),
        ("." in parts or "" in parts, "is no plain path"),
        (len(parts) > PATH_DEPTH_MAX, f"is nested deeper than {PATH_DEPTH_MAX} folders"),
        (len(name) > PATH_LENGTH_MAX, f"is longer than {PATH_LENGTH_MAX} characters"),
        (any(len(p.encode()) > NAME_BYTES_MAX for p in parts), "has a name too long for a file"),
        (any(p.endswith((".", " ")) for p in parts), "ends in a dot or a blank"),
        (any(_WINDOWS_DEVICE.fullmatch(p.lower()) for p in parts), "is a device on Windows"),
    )
    return next((reason for found, reason in checks if found), None)


def _check_kind(path: Path, entry: zipfile.ZipInfo) -> None:
    name, flags = entry.orig_filename, entry.flag_bits
    if flags & (_ENCRYPTED | _STRONG | _MASKED):
        _refuse(path, name, "is encrypted", hint="pack it without a password")
    if flags & _PATCHED or entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        _refuse(path, name, "is packed by a method other than stored or deflated")
    kind = stat.S_IFMT(entry.external_attr >> 16)
    if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
        _refuse(path, name, f"is {_KINDS.get(kind, 'neither a file nor a folder')}")
    if entry.external_attr & (_DOS_VOLUME | _NT_REPARSE_POINT):
        _refuse(path, name, "is a link or a volume label")
    if (kind == stat.S_IFDIR) != name.endswith("/") and kind != 0:
        _refuse(path, name, "is marked as a file and a folder")
    if name.endswith("/") and entry.file_size:
        _refuse(path, name, "is a folder that holds bytes")


def _check_sizes(path: Path, file: BufferedReader, entries: list[zipfile.ZipInfo]) -> None:
    packed = file.seek(0, os.SEEK_END)
    total = sum(entry.file_size for entry in entries)
    largest = max(entries, key=lambda entry: entry.file_size)
    sizes = f"{total / MIB:.0f} MiB unpacked, {packed / MIB:.3g} MiB packed"
    if total > TOTAL_BYTES_MAX or (total > RATIO_BYTES_MIN and total > RATIO_MAX * packed):
        limit = f"{TOTAL_BYTES_MAX // MIB} MiB and {RATIO_MAX} times the packed size"
        _refuse(path, largest.orig_filename, f"makes an absurd size: {sizes}", allowed=limit)
    for name in XML_FILES:
        size = next((e.file_size for e in entries if e.orig_filename == name), 0)
        if size > XML_BYTES_MAX:
            _refuse(path, name, f"has {size / MIB:.0f} MiB", allowed=f"{XML_BYTES_MAX // MIB} MiB")


def _check_places(path: Path, entries: list[zipfile.ZipInfo]) -> None:
    """Refuse entries that share bytes: a small archive could unpack to any size."""
    end, before = 0, ""
    for entry in sorted(entries, key=lambda entry: entry.header_offset):
        if entry.header_offset < end:
            _refuse(path, entry.orig_filename, f"overlaps {before!r}")
        end = entry.header_offset + 30 + len(entry.orig_filename.encode()) + entry.compress_size
        before = entry.orig_filename


def _content(archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> Iterator[bytes]:
    """The bytes of an entry in pieces, one more than declared where there are more."""
    asked = copy.copy(entry)
    asked.file_size += 1
    with archive.open(asked) as stream:
        while piece := stream.read(CHUNK):
            yield piece


def _check_content(path: Path, archive: zipfile.ZipFile, entry: zipfile.ZipInfo) -> None:
    """Refuse an entry whose bytes are not those that the list of entries declares."""
    name, size = entry.orig_filename, 0
    judge = _xml_judge(path, name) if name in XML_FILES else None
    try:
        for piece in _content(archive, entry):
            size += len(piece)
            if judge is not None:
                judge.Parse(piece, False)
        if judge is not None:
            judge.Parse(b"", True)
    except zipfile.BadZipFile as error:
        _refuse(path, name, f"is damaged ({error})", hint="copy or export the FMU again")
    except zlib.error as error:
        _refuse(path, name, f"cannot be unpacked ({error})", hint="copy or export the FMU again")
    except expat.ExpatError as error:
        place = f"{name}, line {error.lineno}, column {error.offset + 1}"
        text = expat.ErrorString(error.code)
        raise UserError(f"the model description is rejected: {place}: {text}", file=path) from error
    except (LookupError, ValueError) as error:
        raise UserError(f"the model description is rejected: {name}: {error}", file=path) from error
    if size != entry.file_size:
        _refuse(path, name, f"has other than the {entry.file_size} bytes that it declares")


def _xml_judge(path: Path, name: str) -> expat.XMLParserType:
    """A parser that refuses document types (entities can only be declared there) and depth."""
    parser = expat.ParserCreate()
    depth = 0

    def doctype(*_: object) -> NoReturn:
        raise UserError(
            f"unsafe archive: {name}, line {parser.CurrentLineNumber}, declares a document type",
            file=path,
            hint="a model description needs none; entities in it can blow up or read files",
        )

    def begin(*_: object) -> None:
        nonlocal depth
        depth += 1
        if depth > XML_DEPTH_MAX:
            raise UserError(
                f"unsafe archive: {name}, line {parser.CurrentLineNumber}, is nested too deep",
                file=path,
                allowed=f"{XML_DEPTH_MAX} elements",
            )

    def end(*_: object) -> None:
        nonlocal depth
        depth -= 1

    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler, parser.EndElementHandler = begin, end
    return parser


def _write(path: Path, archive: zipfile.ZipFile, folder: Path) -> None:
    """Write all entries below `folder`, readable by this user only."""
    for entry in archive.infolist():
        target = folder / entry.orig_filename
        is_folder = entry.orig_filename.endswith("/")
        place = folder
        for part in entry.orig_filename.split("/")[:-1]:
            place = place / part
            place.mkdir(mode=0o700, exist_ok=True)
        if is_folder:
            continue
        runs = (entry.external_attr >> 16) & 0o111
        handle = os.open(
            target,
            os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0),
            0o700 if runs else 0o600,
        )
        with os.fdopen(handle, "wb") as file:
            for piece in _content(archive, entry):
                file.write(piece)


def _entries(archive: zipfile.ZipFile) -> Iterator[Entry]:
    for entry in archive.infolist():
        yield Entry(entry.orig_filename, entry.file_size, entry.orig_filename.endswith("/"))


def _sha256(file: BufferedReader) -> str:
    file.seek(0)
    return hashlib.file_digest(file, "sha256").hexdigest()
