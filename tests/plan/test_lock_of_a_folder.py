"""The lock of a results folder: what it writes, and the folders that it has made."""

import errno
import json
import os
import platform
import sys
from pathlib import Path

import pytest
from results_setup import posix

from axisrig.bench.campaign.results import lock
from axisrig.bench.campaign.results.layout import LOCK
from axisrig.bench.campaign.results.lock import FolderLock, InUseError
from axisrig.kernel.errors import UserError


@posix
def test_the_lock_names_its_holder_and_nothing_that_was_in_the_file_before(tmp_path: Path) -> None:
    path = tmp_path / ".lock"
    path.write_text(f"process 123456789 on {'far' * 40}\nand more\n", encoding="utf-8")
    with FolderLock(tmp_path):
        text = f"process {os.getpid()} on {platform.node() or 'this host'}\n"
        assert path.read_text(encoding="utf-8") == text


def test_folders_that_a_lock_made_go_up_to_the_first_one_with_something_in_it(
    tmp_path: Path,
) -> None:
    with FolderLock(tmp_path / "a" / "b" / "c"):
        (tmp_path / "a" / "kept.txt").touch()
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["kept.txt"]
    with FolderLock(tmp_path / "a" / "b" / "c"):
        (tmp_path / "a" / "b" / "c" / "kept.txt").touch()
    assert (tmp_path / "a" / "b" / "c" / "kept.txt").is_file()


def test_a_lock_makes_its_folder_and_leaves_nothing(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    with FolderLock(tmp_path / "a" / "b" / "c"):
        assert (tmp_path / "a" / "b" / "c" / ".lock").is_file()
    assert list((tmp_path / "a").iterdir()) == []


@pytest.mark.skipif(sys.platform != "linux", reason="forks, and looks at its descriptors")
def test_a_process_that_was_forked_holds_nothing(tmp_path: Path) -> None:
    """It has no such file open, leaves the lock of the other one alone, and may take it later."""
    folder = tmp_path / "out"
    (here, there), (held, free), (ready, tell) = os.pipe(), os.pipe(), os.pipe()
    lock = FolderLock(folder)
    with lock:
        child = os.fork()
        if child == 0:
            found: list[object] = []
            try:
                files = [os.path.realpath(f"/proc/self/fd/{name}") for name in range(64)]
                found.append(str(folder / LOCK) in files)
                lock.__exit__(None, None, None)
                found.append((folder / LOCK).exists())
                try:
                    FolderLock(folder).__enter__()
                except InUseError as error:
                    found.append(error.message)
                os.write(tell, b"x")
                os.read(held, 1)
                with FolderLock(folder):
                    found.append((folder / LOCK).read_text(encoding="utf-8"))
            finally:
                os.write(there, json.dumps([*found, os.getpid()]).encode())
                os._exit(0)
        os.close(tell)
        os.read(ready, 1)  # or its end
    assert not (folder / LOCK).exists()
    os.write(free, b"x")
    os.close(there)
    with os.fdopen(here, "rb") as pipe:
        has_file, is_there, words, taken, own = json.loads(pipe.read())
    os.waitpid(child, 0)
    os.close(held)
    os.close(free)
    os.close(ready)
    assert (has_file, is_there) == (False, True)
    assert f"in use: process {os.getpid()} on " in words
    assert taken.startswith(f"process {own} on ")


@posix
def test_a_lock_whose_holder_has_just_removed_it_is_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The file that was opened has no name any more: a lock on it would hold nobody off."""
    path, tries = tmp_path / LOCK, [0]
    take = lock._try_lock

    def take_late(descriptor: int) -> bool:
        tries[0] += 1
        if tries[0] == 1:
            path.unlink()
        elif tries[0] == 2:
            path.unlink()
            path.write_text("of somebody else", encoding="utf-8")
        return take(descriptor)

    monkeypatch.setattr(lock, "_try_lock", take_late)
    with FolderLock(tmp_path):
        assert tries == [3]
        assert path.read_text(encoding="utf-8").startswith(f"process {os.getpid()} on ")
    assert not path.exists()


@posix
def test_a_lock_that_cannot_be_written_names_its_file_and_holds_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(descriptor: int, data: bytes) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "write", full)
        with (
            pytest.raises(OSError, match="No space left on device") as caught,
            FolderLock(tmp_path),
        ):
            pass
    assert str(caught.value.filename) == str(tmp_path / LOCK)
    with FolderLock(tmp_path):
        assert (tmp_path / LOCK).is_file()


@posix
@pytest.mark.parametrize("text", ["process 4711 on other\n", "", "   \n"])
def test_a_folder_that_another_process_holds_is_refused_by_its_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str
) -> None:
    """The file stays as it is; a holder that has not written yet is another process."""
    (tmp_path / LOCK).write_text(text, encoding="utf-8")
    monkeypatch.setattr(lock, "_try_lock", lambda _: False)
    with pytest.raises(InUseError) as caught, FolderLock(tmp_path):
        pass
    holder = text.strip() or "another process"
    assert caught.value.message == f"the folder is in use: {holder} writes its results there"
    assert caught.value.file == str(tmp_path)
    assert "-o" in str(caught.value.hint)
    assert (tmp_path / LOCK).read_text(encoding="utf-8") == text
    monkeypatch.undo()
    with FolderLock(tmp_path):
        pass


@posix
def test_a_lock_is_a_plain_file_of_one_name(tmp_path: Path) -> None:
    """What has another name, or is none, is a file of somebody else and stays as it is."""
    other, path = tmp_path / "other.txt", tmp_path / "out" / LOCK
    other.write_text("mine", encoding="utf-8")
    path.parent.mkdir()
    for make, words in (
        (lambda: path.hardlink_to(other), "has another name too"),
        (lambda: path.symlink_to(other), "is no plain file"),
        (lambda: path.symlink_to(tmp_path / "nowhere"), "is no plain file"),
        (path.mkdir, "is no plain file"),
    ):
        make()
        with pytest.raises(UserError, match=words) as caught, FolderLock(path.parent):
            pass
        assert caught.value.file == str(path)
        assert other.read_text(encoding="utf-8") == "mine"
        path.rmdir() if path.is_dir() else path.unlink()
    with FolderLock(path.parent):
        pass
