"""Writing files: a full disk is reported with its file, a kill leaves the old or the new one."""

import errno
import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

DISK_FULL = frozenset({errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)})
"""Error numbers of a disk, a quota or a file size that is used up."""


def named(error: OSError, path: Path) -> OSError:
    """Return an error with this file where it names none: writing to an open file has a number."""
    if error.filename is not None or error.errno is None:
        return error
    return OSError(error.errno, os.strerror(error.errno), str(path))


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Give an OSError that names no file this one."""
    try:
        yield
    except OSError as error:
        raise named(error, path) from None


def in_words(error: OSError, subject: str = "the output") -> str:
    """Say which file an OSError is about, or else what, and what is wrong with it."""
    return f"{error.filename or subject}: {error.strerror or error}"


def beside(path: Path) -> Path:
    """Return where a file is written before it takes its place."""
    return path.with_name(f".{path.name}.new")


def opened_new(path: Path) -> TextIO:
    """Open a new file in the place of an old one; where that is a link, its target stays."""
    path.unlink(missing_ok=True)
    return path.open("x", encoding="utf-8", newline="")


def write_whole(path: Path, text: str) -> None:
    """Write a file that is there as a whole or not at all; raises OSError with its name."""
    write_parts(path, (text,))


def write_parts(path: Path, parts: Iterable[str]) -> None:
    """Write the parts of a text one after the other, as `write_whole` does."""
    new = beside(path)
    try:
        with naming(path):
            with opened_new(new) as file:
                file.writelines(parts)
            new.replace(path)
    except OSError:
        new.unlink(missing_ok=True)
        raise


def json_text(content: Mapping[str, object]) -> str:
    """Return an object as JSON, equal objects as equal texts."""
    return json.dumps(content, indent=1, ensure_ascii=False, sort_keys=True) + "\n"


def append(path: Path, text: str) -> None:
    """Append a text or nothing; raises OSError with the name of the file."""
    data = text.encode()
    with path.open("ab", buffering=0) as file:
        size = file.seek(0, os.SEEK_END)
        try:
            with naming(path):
                while data:
                    data = data[file.write(data) or 0 :]
        except OSError:
            file.truncate(size)
            raise


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file as hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
