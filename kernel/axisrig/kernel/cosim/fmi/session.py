"""The private folder in which a process and its children unpack FMUs.

It goes with the process that made it. A process that was killed leaves its own, and the next one
removes it: `owner` in it is locked as long as one of its processes lives.
"""

import atexit
import os
import shutil
import sys
import tempfile
from contextlib import suppress
from pathlib import Path

_PREFIX, _OWNER = "axisrig-fmu-", "owner"
_KEPT_NS = 7 * 86_400 * 10**9
"""So much older than a new one a folder without `owner` is that goes: older releases made none."""

_SESSION: list[Path] = []

_OWN: dict[Path, tuple[int, int]] = {}
"""Of each folder that this process made: the process, and the descriptor of its lock."""

if sys.platform == "win32":

    def _try_lock(_descriptor: int) -> bool:
        """Files that are in use cannot be removed there: no lock is needed."""
        return True

else:
    import fcntl

    def _try_lock(descriptor: int) -> bool:
        # flock: children that are forked hold it as well
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
        return True


def session_folder() -> Path:
    """Return the private folder in which FMUs are unpacked; it goes with the process that made it.

    Made before children are started and handed to them, it outlives their crash.
    """
    if not _SESSION:
        folder = Path(tempfile.mkdtemp(prefix=_PREFIX))
        _OWN[folder] = os.getpid(), _owned(folder)
        atexit.register(_remove, folder)
        _SESSION.append(folder)
        _remove_dead(folder)
    return _SESSION[0]


def remove_session_folder() -> None:
    """Remove the folder that this process made, before its end; no FMU may be opened after it.

    For a process that has little time once it is asked to end.
    """
    for folder in list(_OWN):
        _remove(folder)


def share_session_folder(folder: Path) -> None:
    """Unpack into the folder of the process that started this one."""
    _SESSION[:] = [folder]


def _remove(folder: Path) -> None:
    process, descriptor = _OWN.get(folder, (0, -1))
    if process == os.getpid():  # a forked child must not take its siblings' files away
        del _OWN[folder]
        with suppress(OSError):
            os.close(descriptor)
        shutil.rmtree(folder, ignore_errors=True)


def _owned(folder: Path) -> int:
    """Make `owner` and return it, locked until this process and its children have ended."""
    unlocked = folder / f"{_OWNER}.new"  # nobody takes it for that of a dead process
    descriptor = os.open(unlocked, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
    _try_lock(descriptor)
    unlocked.rename(folder / _OWNER)
    return descriptor


def _remove_dead(own: Path) -> None:
    """Remove the folders of processes of this user that were killed."""
    made = own.stat()
    for folder in own.parent.glob(f"{_PREFIX}*"):
        with suppress(OSError):
            state = folder.lstat()
            is_own = folder.is_dir() and not folder.is_symlink() and state.st_uid == made.st_uid
            if folder != own and is_own and _is_dead(folder, made.st_mtime_ns - state.st_mtime_ns):
                shutil.rmtree(folder, ignore_errors=True)


def _is_dead(folder: Path, age_ns: int) -> bool:
    owner = folder / _OWNER
    if not owner.is_file() or owner.is_symlink():
        return age_ns > _KEPT_NS
    descriptor = os.open(owner, os.O_RDWR)
    try:
        return _try_lock(descriptor)
    finally:
        os.close(descriptor)
