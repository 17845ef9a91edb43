"""A hash of the files that an FMU depends on; they are read again after somebody wrote to one.

Every start of a machine asks for it once for each FMU. What is not noticed: a file that somebody
writes with the same size within the same tick of the file system's clock, some milliseconds.
"""

import hashlib
import os
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

# Name in the hash, path, and what changes when a file is written: times of content and of the
# entry, ns, and size, bytes
Stamp = tuple[str, str, int, int, int]
_ASIDE = ("__pycache__",)


def files_below(folder: Path, endings: Sequence[str]) -> tuple[Stamp, ...]:
    """The files below a folder whose names end so, in the order of their names."""
    found: list[Stamp] = []
    waiting = [("", os.fspath(folder))]
    while waiting:
        name, place = waiting.pop()
        with os.scandir(place) as entries:
            for entry in entries:
                inside = f"{name}{entry.name}"
                if entry.is_dir():
                    if entry.name not in _ASIDE:
                        waiting.append((f"{inside}/", entry.path))
                elif entry.name.endswith(tuple(endings)):
                    found.append(_stamp(inside, entry))
    return tuple(sorted(found))


def files_named(paths: Sequence[Path]) -> tuple[Stamp, ...]:
    """Single files, in the order given."""
    return tuple(_stamp(path.name, path) for path in paths)


def _stamp(name: str, file: os.DirEntry[str] | Path) -> Stamp:
    state = file.stat()
    return name, os.fspath(file), state.st_mtime_ns, state.st_ctime_ns, state.st_size


@lru_cache(maxsize=32)
def hash_of(files: tuple[Stamp, ...]) -> bytes:
    """sha256 over names and contents, 32 bytes."""
    digest = hashlib.sha256()
    for name, path, *_ in files:
        for text in (name.encode(), Path(path).read_bytes()):
            digest.update(len(text).to_bytes(8, "big"))
            digest.update(text)
    return digest.digest()
