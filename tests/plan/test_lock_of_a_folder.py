"""The lock of a results folder: what it writes, and the folders that it has made."""

import os
import platform
from pathlib import Path

from results_setup import posix

from axisrig.bench.campaign.results.lock import FolderLock


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
