"""One campaign, one folder: a lock of the operating system on `DIR/.lock`.

The lock ends with its process, however that ends. The file holds host and process id as text, for
the second one. Processes that the campaign starts do not hold it.
"""

import os
import platform
import sys
from contextlib import suppress
from itertools import takewhile
from pathlib import Path
from types import TracebackType
from typing import Self

from axisrig.bench.campaign.results.layout import LOCK
from axisrig.bench.files import naming
from axisrig.kernel.errors import UserError

_NO_LINK = getattr(os, "O_NOFOLLOW", 0)

_held: dict[Path, str] = {}
"""Folders that this process holds. POSIX locks do not keep a process out of its own."""
_descriptors: set[int] = set()
"""Of the files that it has locked."""


def _let_go() -> None:
    """In a process that was forked: it holds nothing, and foreign code in it has no such file."""
    for descriptor in _descriptors:
        os.close(descriptor)
    _descriptors.clear()
    _held.clear()


if sys.platform != "win32":
    os.register_at_fork(after_in_child=_let_go)

if sys.platform == "win32":
    import msvcrt

    # Nobody else can read bytes that are locked, so these lie far from the text
    _PLACE = 1 << 30

    def _try_lock(descriptor: int) -> bool:
        os.lseek(descriptor, _PLACE, os.SEEK_SET)
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True

else:
    import fcntl

    def _try_lock(descriptor: int) -> bool:
        try:
            # Not flock: a process that is forked while it is held would hold it as well
            fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError):
            return False
        return True


class InUseError(UserError):
    """Another process, or this one, holds the folder."""


class FolderLock:
    """Holds a folder for this process, as a context manager; makes the folder where there is none.

    A folder that it made and that is empty at the end is removed again.
    Raises InUseError on entry, with the holder, when the folder is in use, and UserError where
    `.lock` is something else.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._key = folder
        self._descriptor = -1
        self._made: list[Path] = []

    def __enter__(self) -> Self:
        self._made = list(takewhile(_is_missing, (self.folder, *self.folder.parents)))
        self.folder.mkdir(parents=True, exist_ok=True)
        self._key = self.folder.resolve()
        if self._key in _held:
            raise self._refused(_held[self._key])
        path = self.folder / LOCK
        while True:
            descriptor = _opened(path)
            if not _try_lock(descriptor):
                os.lseek(descriptor, 0, os.SEEK_SET)
                holder = os.read(descriptor, 1000).decode(errors="replace").strip()
                os.close(descriptor)
                raise self._refused(holder or "another process")
            if _is_file(descriptor, path):
                break
            os.close(descriptor)  # its holder has just removed it
        holder = f"process {os.getpid()} on {platform.node() or 'this host'}"
        try:
            with naming(path):
                os.ftruncate(descriptor, 0)
                os.lseek(descriptor, 0, os.SEEK_SET)
                os.write(descriptor, f"{holder}\n".encode())
        except OSError:
            os.close(descriptor)
            raise
        self._descriptor = descriptor
        _descriptors.add(descriptor)
        _held[self._key] = holder
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._descriptor not in _descriptors:
            return  # of the process from which this one was forked
        _descriptors.remove(self._descriptor)
        path = self._key / LOCK
        if sys.platform == "win32":  # an open file cannot be removed there
            os.close(self._descriptor)
            _remove(path)
        else:
            _remove(path)
            os.close(self._descriptor)
        del _held[self._key]
        for made in self._made:
            if not made.is_dir() or any(made.iterdir()):
                break
            made.rmdir()

    def _refused(self, holder: str) -> InUseError:
        return InUseError(
            f"the folder is in use: {holder} writes its results there",
            file=self.folder,
            hint="wait for its end, or name another folder with -o",
        )


def _opened(path: Path) -> int:
    """Open the lock. Raises UserError for one that is, or may be, a file of somebody else."""
    hint = "remove it: a lock is a plain file that axisrig makes anew"
    if path.is_symlink() or (path.exists() and not path.is_file()):
        raise UserError("the lock of the folder is no plain file", file=path, hint=hint)
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | _NO_LINK, 0o644)
    if os.fstat(descriptor).st_nlink > 1:
        os.close(descriptor)
        raise UserError("the lock of the folder has another name too", file=path, hint=hint)
    return descriptor


def _is_file(descriptor: int, path: Path) -> bool:
    """Whether an open file is still the one of that name."""
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except FileNotFoundError:
        return False


def _is_missing(path: Path) -> bool:
    return not path.exists()


def _remove(path: Path) -> None:
    with suppress(OSError):  # somebody has it open already, or the folder is gone
        path.unlink()
