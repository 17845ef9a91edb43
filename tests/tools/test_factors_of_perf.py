"""`axisrig perf`: factors and shares of runs that take a known time."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.perf import perf
from axisrig.bench.tools.perf.perf import measure

PLAN = Path(__file__).parents[2] / "testplans" / "latch_accuracy.csv"


class Clock:
    """Seconds that a test spends; wall time goes twice as fast."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def cpu_s(self) -> float:
        return self.now_s

    def cpu_ns(self) -> int:
        return round(self.now_s * 1e9)

    def wall_ns(self) -> int:
        return round(self.now_s * 2e9)


@pytest.fixture
def timed(monkeypatch: pytest.MonkeyPatch) -> Callable[..., dict[str, Any]]:
    """Measure runs that take so long, of 20 s simulated in some cycles."""

    def made(*runs_s: float, cycles: int | None = 4, compiled: bool = True) -> dict[str, Any]:
        clock, lasts = Clock(), iter([*runs_s, 8.0])
        series = None if cycles is None else SimpleNamespace(column=lambda _: range(cycles))

        def run_case(*_: Any) -> Any:
            clock.now_s += next(lasts)
            return SimpleNamespace(
                error=None, sim_s=20.0, loop_s=1.0, frame_log_sha256="ab", series=series
            )

        class Folder:
            def __enter__(self) -> "Folder":
                return self

            def __exit__(self, *_: object) -> None:
                return None

            def files_of(self, _run: str) -> None:
                return None

            def add(self, _result: object) -> None:
                return None

        monkeypatch.setattr(perf, "prepare", lambda _: None)
        monkeypatch.setattr(perf, "run_case", run_case)
        monkeypatch.setattr(perf, "ResultsWriter", lambda *_, **__: Folder())
        monkeypatch.setattr(perf, "build_manifest", lambda *_, **__: {})
        monkeypatch.setattr(perf, "is_compiled", lambda: compiled)
        given: Any = clock
        return measure(PLAN, "f600", len(runs_s), given, lambda _: Path())

    return made


def test_factors_of_two_runs_are_of_what_is_between_them(
    timed: Callable[..., dict[str, Any]],
) -> None:
    """2 and 3 s of CPU, 4 and 6 s of wall time: 2.5 and 5 s."""
    found = timed(2.0, 3.0)
    assert (found["wall_s_min"], found["wall_s"], found["wall_s_max"]) == (4.0, 5.0, 6.0)
    assert found["real_time_factor"] == pytest.approx(4.0)
    assert (found["cpu_s"], found["cpu_factor"]) == (2.5, pytest.approx(8.0))
    assert found["beyond_simulation_ms"] == pytest.approx(2000.0)  # of the second one alone
    back = timed(3.0, 2.0)
    assert (back["wall_s_min"], back["wall_s"], back["wall_s_max"]) == (4.0, 5.0, 6.0)
    assert back["beyond_simulation_ms"] == pytest.approx(1000.0)


@pytest.mark.parametrize("cycles", [None, 0, 1, 4])
@pytest.mark.parametrize("compiled", [True, False])
def test_what_has_no_cycles_is_divided_by_one(
    timed: Callable[..., dict[str, Any]], cycles: int | None, compiled: bool
) -> None:
    """16 s of wall time in the run that is taken apart; nothing of it in a part."""
    found = timed(2.0, cycles=cycles, compiled=compiled)
    assert found["cycles"] == (cycles or 0)
    split = found["cycle_us"]
    assert split.pop("rest") == pytest.approx(16e6 / max(cycles or 0, 1))
    assert split == ({} if compiled else dict.fromkeys(perf.PARTS, 0.0))
