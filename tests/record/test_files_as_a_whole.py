"""Files that are written as a whole or not at all, on a disk that becomes full."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from axisrig.bench.files import append, beside, write_parts, write_whole

pytestmark = pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")


@contextmanager
def no_more_than(size: int) -> Iterator[None]:
    """Let no file of this process become longer, as on a full disk; the signal is ignored."""
    import resource  # noqa: PLC0415 - not on Windows

    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize("room", [0, 1, 7])
def test_a_line_that_does_not_fit_leaves_nothing_of_it(tmp_path: Path, room: int) -> None:
    path = tmp_path / "log.csv"
    append(path, "first\n")
    append(path, "second\n")
    length = len("first\nsecond\n")
    with no_more_than(length + room), pytest.raises(OSError, match="too large") as full:
        append(path, "a third line\n")
    assert full.value.filename == str(path)
    assert path.read_bytes() == b"first\nsecond\n"
    append(path, "third, \u00b5\n")
    assert path.read_text(encoding="utf-8") == "first\nsecond\nthird, \u00b5\n"


@pytest.mark.parametrize("old", [None, "old"])
def test_a_file_that_does_not_fit_leaves_the_old_one(tmp_path: Path, old: str | None) -> None:
    path = tmp_path / "whole.json"
    if old is not None:
        write_whole(path, old)
    with no_more_than(10), pytest.raises(OSError, match="too large") as full:
        write_parts(path, ("0123456", "789abc", "def" * 10_000))
    assert full.value.filename == str(path)
    assert not beside(path).exists()
    assert (path.read_text(encoding="utf-8") if path.exists() else None) == old
    write_parts(path, ("new", "er"))
    assert (path.read_text(encoding="utf-8"), beside(path).exists()) == ("newer", False)
