"""The lock of a results folder: what it writes, and the folders that it has made."""

import json
import os
import platform
import sys
from pathlib import Path

import pytest
from results_setup import posix

from axisrig.bench.campaign.results.layout import LOCK
from axisrig.bench.campaign.results.lock import FolderLock, InUseError


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
