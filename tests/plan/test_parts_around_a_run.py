"""What a campaign does around its runs: garbage, folders, sums, hashes, orders to processes."""

import gc
import os
import platform
from hashlib import sha256
from multiprocessing import Pipe
from pathlib import Path

import pytest

from axisrig.bench.campaign.channel import Inbox
from axisrig.bench.campaign.collector import without_collector
from axisrig.bench.campaign.results.build_info import hash_of_sources
from axisrig.bench.campaign.results.case_files import content_hash
from axisrig.bench.campaign.results.layout import logs_beside
from axisrig.bench.campaign.results.lock import FolderLock
from axisrig.bench.campaign.results.sums import altered_files, sums_of
from axisrig.bench.campaign.talk import FEW, Talk

posix = pytest.mark.skipif(os.name != "posix", reason="limits and descriptors of POSIX")


@pytest.mark.parametrize("was_enabled", [True, False])
@pytest.mark.parametrize("breaks_off", [True, False])
def test_the_garbage_collector_is_after_a_run_as_it_was_before(
    was_enabled: bool, breaks_off: bool
) -> None:
    before = gc.isenabled()
    (gc.enable if was_enabled else gc.disable)()
    try:
        with without_collector():
            assert not gc.isenabled()
            with without_collector():
                assert not gc.isenabled()
            assert not gc.isenabled()  # the inner one has found it switched off
            if breaks_off:
                raise KeyError
    except KeyError:
        assert breaks_off
    finally:
        now = gc.isenabled()
        (gc.enable if before else gc.disable)()
    assert now is was_enabled


def test_few_results_are_shown_each_one_unless_nothing_is_to_be_shown() -> None:
    for count, shown in ((0, Talk.ALL), (FEW, Talk.ALL), (FEW + 1, Talk.SHORT)):
        assert Talk.SHORT.of(count) is shown
        assert Talk.NONE.of(count) is Talk.NONE
        assert Talk.ALL.of(count) is Talk.ALL


def test_logs_of_segments_are_those_of_the_whole_name_of_the_run() -> None:
    """One that begins with it is another run; that of all segments is beside none."""
    names = ["a@can1.blf", "a@ec 2.pcapng", "ab@can1.blf", "a-1@can1.blf", "b-a@can1.blf", "a.blf",
             "a@can1.txt"]  # fmt: skip
    assert logs_beside("a", names) == ["a@can1.blf", "a@ec 2.pcapng"]


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


@pytest.mark.parametrize("has_trace", [True, False])
def test_every_file_of_a_run_is_compared_with_its_own_sum(tmp_path: Path, has_trace: bool) -> None:
    """Also of a run without a series; several logs have one sum each."""
    names = ["runs/r.json", "bus/r.blf", "bus/r@ec1.pcapng", "bus/r@ec2.pcapng"]
    names += ["traces/r.parquet"] if has_trace else []
    for name in names:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(name.encode())
    row = sums_of(tmp_path, "r", names)
    assert row["trace_sha256"] == (sha256(b"traces/r.parquet").hexdigest() if has_trace else "")
    assert list(altered_files(tmp_path, "r", row)) == []
    for name in names:
        (tmp_path / name).write_bytes(b"of another run")
        assert list(altered_files(tmp_path, "r", row)) == [name]
        (tmp_path / name).write_bytes(name.encode())
    (tmp_path / "traces").mkdir(exist_ok=True)
    (tmp_path / "traces/r.parquet").write_bytes(b"of another run")
    assert list(altered_files(tmp_path, "r", row)) == ["traces/r.parquet"]


def test_names_and_contents_of_sources_make_their_hash(tmp_path: Path) -> None:
    """Neither another name nor two files with each other's content are the same sources."""
    one, other = tmp_path / "a.py", tmp_path / "b.py"
    one.write_text("1", encoding="utf-8")
    other.write_text("2", encoding="utf-8")
    found = [hash_of_sources([tmp_path])]
    one.write_text("2", encoding="utf-8")
    other.write_text("1", encoding="utf-8")
    found.append(hash_of_sources([tmp_path]))
    other.rename(tmp_path / "c.py")
    found.append(hash_of_sources([tmp_path]))
    (tmp_path / "inner").mkdir()
    (tmp_path / "c.py").rename(tmp_path / "inner" / "c.py")
    found.append(hash_of_sources([tmp_path]))
    (tmp_path / "fmus" / "shipped").mkdir(parents=True)
    (tmp_path / "fmus" / "shipped" / "z.fmu").write_text("a wheel alone has it", encoding="utf-8")
    assert len(set(found)) == len(found)
    assert hash_of_sources([tmp_path]) == found[-1]


def test_a_file_is_hashed_anew_when_it_was_written_or_replaced(tmp_path: Path) -> None:
    """Within one second, with as many bytes; or another file with the same time in its place."""
    path, other = tmp_path / "part.nc", tmp_path / "other.nc"
    second_ns = 1_700_000_000 * 10**9

    def written(file: Path, text: bytes, after_ns: int) -> None:
        file.write_bytes(text)
        os.utime(file, ns=(second_ns, second_ns + after_ns))

    written(path, b"G1 Z1", 0)
    assert content_hash(path) == sha256(b"G1 Z1").hexdigest()
    written(path, b"G1 Z2", 10**6)
    assert content_hash(path) == sha256(b"G1 Z2").hexdigest()
    written(other, b"G1 Z3", 10**6)
    other.replace(path)
    assert content_hash(path) == sha256(b"G1 Z3").hexdigest()
    path.unlink()
    assert content_hash(path) == ""


@posix
def test_who_has_sent_an_order_does_not_wait_for_its_answer() -> None:
    parent, child = Pipe()
    with parent, child:
        inbox = Inbox(parent, lambda: 0.0)
        for order in ("first", ["second", 2]):
            inbox.order(order)
            assert child.recv() == order
            assert not os.get_blocking(parent.fileno())
            assert inbox.take() is None
