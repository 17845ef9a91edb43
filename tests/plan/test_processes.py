"""Processes that run rows: who gets the next one, and when."""

import errno
import os
import struct
import subprocess
import sys
import time
from collections.abc import Callable
from multiprocessing import Pipe
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign import channel, processes, worker
from axisrig.bench.campaign.channel import MAGIC, STALL_S, ChannelError, Inbox
from axisrig.bench.campaign.processes import Died, _Crew, run_apart, run_as_they_end
from axisrig.kernel.cosim.fmi.journal import LastCall

WAIT_S = 20.0

posix = pytest.mark.skipif(os.name != "posix", reason="limits and descriptors of POSIX")


def _begin(folder: Path, number: int) -> int:
    (folder / str(number)).touch()
    return number


@pytest.mark.long
def test_the_next_row_begins_while_the_results_of_the_last_are_worked_on(tmp_path: Path) -> None:
    results = run_apart(_begin, [[tmp_path, n] for n in range(3)], jobs=1, is_fresh=False)
    assert next(results) == 0
    end_s = time.monotonic() + WAIT_S
    while not (tmp_path / "1").exists() and time.monotonic() < end_s:  # nobody asks for its answer
        time.sleep(0.01)
    assert (tmp_path / "1").exists()
    assert list(results) == [1, 2]


def _wait_for(path: Path | None, number: int) -> int:
    end_s = time.monotonic() + WAIT_S
    while path is not None and not path.exists() and time.monotonic() < end_s:
        time.sleep(0.01)
    return 10 * number


@pytest.mark.long
def test_results_come_as_their_tasks_end(tmp_path: Path) -> None:
    """The first task waits until the results of the two others have been taken."""
    tasks = [[tmp_path / "go", 0], [None, 1], [None, 2]]
    results = run_as_they_end(
        _wait_for, tasks, jobs=2, is_fresh=[False] * 3, timeout_s=None, call_limit_s=WAIT_S
    )
    assert [next(results), next(results)] == [(1, 10), (2, 20)]
    (tmp_path / "go").touch()
    assert list(results) == [(0, 0)]


@pytest.mark.long
def test_a_process_ends_after_so_many_tasks() -> None:
    """The answers stay in order; each process did the number of tasks that it may."""
    done = list(run_apart(os.getpid, [[] for _ in range(7)], jobs=1, is_fresh=False, tasks_max=3))
    counts = [done.count(process) for process in dict.fromkeys(done)]
    assert counts == [3, 3, 1]


@pytest.mark.long
def test_who_follows_hears_of_each_task_when_it_begins_and_when_it_has_ended() -> None:
    """Three tasks in two processes: two begin at once, the third when one has ended."""
    heard: list[tuple[int, bool]] = []
    tasks = [[number] for number in range(3)]
    done = run_apart(abs, tasks, jobs=2, is_fresh=False, news=lambda *one: heard.append(one))
    assert list(done) == [0, 1, 2]
    assert heard[:2] == [(0, True), (1, True)]
    assert sorted(heard) == [(number, begins) for number in range(3) for begins in (False, True)]
    assert heard.index((2, True)) > min(heard.index((0, False)), heard.index((1, False)))


# ---- what foreign code in a process can do to the one that watches


def _answer_of() -> int:
    """The descriptor of the channel on which this process answers."""
    return worker._ANSWERS[0].fileno()


def _interfere(content: bytes, rests: bool) -> str:
    """Write into the channel of the answer; rests: and answer nothing after that."""
    os.write(_answer_of(), content)
    if rests:
        time.sleep(WAIT_S)
    return "answered"


HEAD = channel.MAGIC + struct.pack("<Q", 10)


@pytest.mark.long
@pytest.mark.parametrize(
    ("content", "rests", "words"),
    [
        (b"something", False, "b'something"),
        (b"\0", True, "is no answer"),
        (HEAD + b"0123456789" + b"#" * 32, False, "does not fit its checksum"),
        (channel.MAGIC + b"\xff" * 8, False, "at most"),
        (HEAD, True, "broke off after 16 bytes"),
        (channel.MAGIC[:3], True, "broke off after 3 bytes"),
    ],
)
def test_what_is_no_answer_costs_one_row(
    monkeypatch: pytest.MonkeyPatch, content: bytes, rests: bool, words: str
) -> None:
    """And nobody waits for the rest of it: each way ends long before the process does."""
    monkeypatch.setattr(channel, "STALL_S", 0.2)
    began_s = time.monotonic()
    tasks: list[list[object]] = [[content, rests], [b"", False]]
    died, other = run_apart(_interfere, tasks)
    assert isinstance(died, Died)
    assert "wrote into the channel of its answer" in died.reason
    assert words in died.reason
    assert other == "answered"
    assert time.monotonic() - began_s < WAIT_S / 2


def test_an_answer_that_is_too_large_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(channel, "ANSWER_BYTES_MAX", 1000)
    with pytest.raises(RuntimeError, match=r"the answer has .* bytes, at most 1000"):
        list(run_apart(bytes, [[2000]]))


@pytest.mark.long
def test_a_large_order_arrives() -> None:
    assert list(run_apart(len, [[bytes(3_000_000)], [b""]], is_fresh=False)) == [3_000_000, 0]


def _write_with_a_limit(path: Path, limit: int | None) -> int:
    import resource  # noqa: PLC0415 - not on Windows

    if limit is not None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    with path.open("wb", buffering=0) as file:
        return file.write(bytes(10)) + (file.write(bytes(10)) or 0)


@pytest.mark.long
@posix
def test_a_limit_that_was_lowered_is_no_full_disk(tmp_path: Path) -> None:
    """It ends its own row; a disk that is full, of which nothing was lowered, ends the campaign."""
    died, other = run_apart(_write_with_a_limit, [[tmp_path / "a", 10], [tmp_path / "b", None]])
    assert isinstance(died, Died)
    assert "it had lowered limits of its process: RLIMIT_FSIZE to 10" in died.reason
    assert other == 20
    with pytest.raises(OSError, match="No space left"):
        list(run_apart(_full, [[]]))


def _full() -> None:
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "file")


def _sockets(_number: int) -> int:
    """How many channels this process has, and that it holds nobody else's."""
    assert not worker.PARENT_ENDS
    links = [str(path.readlink()) for path in Path("/proc/self/fd").iterdir() if path.is_symlink()]
    return sum(link.startswith("socket:") for link in links)


@pytest.mark.long
@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_a_process_has_no_end_of_another(tmp_path: Path) -> None:
    """Those that are started later have no more descriptors than the first."""
    first, *others = run_apart(_sockets, [[n] for n in range(4)], jobs=4)
    assert others == [first] * 3


CAMPAIGN = """\
import sys
from axisrig.bench.campaign.processes import run_apart
sys.path.insert(0, {folder!r})
from held import hold
print(list(run_apart(hold, [[n] for n in range(2)], jobs=2)))
"""
HELD = """\
import os, time
from pathlib import Path


def hold(number):
    Path({folder!r}, f"pid{{number}}").write_text(str(os.getpid()))
    time.sleep(60)  # as an FMU that does not come back
"""


@pytest.mark.long
@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere they end with their task")
def test_workers_end_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    """SIGKILL to the parent alone, in the middle of their tasks."""
    (tmp_path / "held.py").write_text(HELD.format(folder=str(tmp_path)), encoding="utf-8")
    script = tmp_path / "campaign.py"
    script.write_text(CAMPAIGN.format(folder=str(tmp_path)), encoding="utf-8")
    files = [tmp_path / f"pid{number}" for number in range(2)]
    with subprocess.Popen([sys.executable, script]) as parent:
        assert _soon(lambda: all(path.is_file() and path.read_text() for path in files))
        parent.kill()
    workers = [int(path.read_text()) for path in files]
    assert _soon(lambda: not any(_lives(pid) for pid in workers))


def _soon(is_so: Callable[[], bool]) -> bool:
    end_s = time.monotonic() + WAIT_S
    while not is_so() and time.monotonic() < end_s:
        time.sleep(0.01)
    return is_so()


def _lives(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


@pytest.mark.long
def test_a_task_that_needs_a_new_process_shares_it_with_nobody() -> None:
    """Between two that may share one."""
    fresh = [False, False, True, False, False]
    done = list(run_apart(os.getpid, [[] for _ in fresh], jobs=1, is_fresh=fresh))
    assert [done.index(process) for process in done] == [0, 0, 2, 3, 3]


class End:
    """An end of a channel, as `multiprocessing` has it."""

    def __init__(self, number: int) -> None:
        self._number = number

    def fileno(self) -> int:
        return self._number


@posix
def test_an_answer_may_come_in_parts_as_long_as_each_comes_in_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The time runs from the last part on, not from the first or from the begin of the process."""
    frames: list[bytes] = []

    def write(_: int, data: bytes) -> int:
        frames.append(bytes(data))
        return len(data)

    with monkeypatch.context() as patch:
        patch.setattr(os, "write", write)
        for content in ("first", {"second": 2}):
            channel.send(End(0), content)  # type: ignore[arg-type]
    reads, writes = os.pipe()
    now_s = [1000.0]
    inbox = Inbox(End(reads), lambda: now_s[0])  # type: ignore[arg-type]
    try:
        assert inbox.take() is None
        now_s[0] += 10 * STALL_S  # nothing has begun
        assert inbox.take() is None
        for begin in range(0, len(frames[0]) - 1, 20):
            os.write(writes, frames[0][begin : begin + 20][: len(frames[0]) - 1 - begin])
            assert inbox.take() is None
            now_s[0] += STALL_S  # so long it may stay as it is
            assert inbox.take() is None
        os.write(writes, frames[0][-1:] + frames[1])
        assert [inbox.take() for _ in range(3)] == ["first", {"second": 2}, None]
        os.write(writes, MAGIC)
        assert inbox.take() is None
        now_s[0] += STALL_S + 0.001
        with pytest.raises(ChannelError, match=f"broke off after {len(MAGIC)} bytes"):
            inbox.take()
    finally:
        os.close(reads)
        os.close(writes)


@posix
@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"hello", "b'hello' is no answer"),
        (MAGIC[:-1] + b"\x02", "is no answer"),
        (MAGIC + struct.pack("<Q", channel.ANSWER_BYTES_MAX + 1), "at most 268435456 may come"),
        (MAGIC + struct.pack("<Q", 1) + b"x" + bytes(32), "does not fit its checksum"),
    ],
)
def test_what_is_no_answer_is_refused_at_once(data: bytes, words: str) -> None:
    reads, writes = os.pipe()
    try:
        os.write(writes, data)
        with pytest.raises(ChannelError, match=words):
            Inbox(End(reads), lambda: 0.0).take()  # type: ignore[arg-type]
        inbox = Inbox(End(reads), lambda: 0.0)  # type: ignore[arg-type]
        os.close(writes)
        with pytest.raises(EOFError):
            inbox.take()
    finally:
        os.close(reads)


def test_each_call_has_the_whole_time_of_a_call(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """Of 10 s: from when a call was seen first, of every task; a row of short calls may be long."""
    now_s, note = [100.0], tmp_path / "note"
    monkeypatch.setattr(processes, "time", SimpleNamespace(monotonic=lambda: now_s[0]))
    calls: list[LastCall | None] = [None]
    monkeypatch.setattr(processes.journal, "last_call", lambda _: calls[0])
    crew = _Crew(abs, [], [], 1, None, 50.0, 10.0, 9, lambda _number, _begins: None)
    doing: Any = SimpleNamespace(note=note, began_s=100.0, call_s=100.0, call=0)

    def look(after_s: float, number: int, *, is_inside: bool = True) -> str:
        now_s[0] += after_s
        calls[0] = LastCall(number, is_inside, "a.fmu", "z", "fmi3DoStep", 0)
        died = crew._excess(doing)
        return "" if died is None else died.reason

    assert look(9.0, 1) == ""
    assert look(9.9, 1) == ""
    assert look(0.05, 2) == look(9.9, 2) == ""
    assert look(5.0, 2, is_inside=False) == ""  # it has come back, nothing is under way
    assert look(5.0, 2, is_inside=False) == look(0.0, 3) == ""
    assert look(10.0, 3).startswith("a call did not come back within 10 s: it was in fmi3DoStep")
    calls[0] = None
    now_s[0] = 149.9
    assert crew._excess(doing) is None
    now_s[0] = 150.0
    died = crew._excess(doing)
    assert died is not None
    assert died.reason == "no end within 50 s of wall time"
    assert died.is_timeout


def _who(content: bytes) -> int:
    if content:
        os.write(_answer_of(), content)
    return os.getpid()


@pytest.mark.long
def test_who_wrote_what_is_no_answer_gets_no_further_row() -> None:
    """Its process may write again: the rows after it have another one."""
    tasks = [[content] for content in (b"", b"no answer", b"", b"")]
    first, died, *after = run_apart(_who, tasks, is_fresh=False)
    assert isinstance(died, Died)
    assert len({*after}) == 1
    assert first not in after


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
