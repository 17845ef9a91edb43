"""Processes that run rows: who gets the next one, and when."""

import os
import time
from pathlib import Path

from axisrig.bench.campaign.processes import run_apart, run_as_they_end

WAIT_S = 20.0


def _begin(folder: Path, number: int) -> int:
    (folder / str(number)).touch()
    return number


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


def test_results_come_as_their_tasks_end(tmp_path: Path) -> None:
    """The first task waits until the results of the two others have been taken."""
    tasks = [[tmp_path / "go", 0], [None, 1], [None, 2]]
    results = run_as_they_end(
        _wait_for, tasks, jobs=2, is_fresh=[False] * 3, timeout_s=None, call_limit_s=WAIT_S
    )
    assert [next(results), next(results)] == [(1, 10), (2, 20)]
    (tmp_path / "go").touch()
    assert list(results) == [(0, 0)]


def test_a_process_ends_after_so_many_tasks() -> None:
    """The answers stay in order; each process did the number of tasks that it may."""
    done = list(run_apart(os.getpid, [[] for _ in range(7)], jobs=1, is_fresh=False, tasks_max=3))
    counts = [done.count(process) for process in dict.fromkeys(done)]
    assert counts == [3, 3, 1]


def test_who_follows_hears_of_each_task_when_it_begins_and_when_it_has_ended() -> None:
    """Three tasks in two processes: two begin at once, the third when one has ended."""
    heard: list[tuple[int, bool]] = []
    tasks = [[number] for number in range(3)]
    done = run_apart(abs, tasks, jobs=2, is_fresh=False, news=lambda *one: heard.append(one))
    assert list(done) == [0, 1, 2]
    assert heard[:2] == [(0, True), (1, True)]
    assert sorted(heard) == [(number, begins) for number in range(3) for begins in (False, True)]
    assert heard.index((2, True)) > min(heard.index((0, False)), heard.index((1, False)))
