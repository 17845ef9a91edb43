"""What `axisrig perf` makes of clocks and calls, from a clock that the test sets: nothing runs."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.tools.perf import perf, profile, stages
from axisrig.bench.tools.perf.perf import Row, Stack, Timed, counters, measure, show
from axisrig.kernel.errors import UserError

PLAN = Path(__file__).parents[2] / "testplans" / "latch_accuracy.csv"


class Clock:
    """Seconds of CPU; wall time goes twice as fast."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def cpu_s(self) -> float:
        return self.now_s

    def cpu_ns(self) -> int:
        return round(self.now_s * 1e9)

    def wall_ns(self) -> int:
        return round(self.now_s * 2e9)

    def spend(self, seconds: float) -> None:
        self.now_s += seconds


def test_time_of_a_call_counts_once_for_the_innermost_part() -> None:
    clock = Clock()

    class Own:
        def outer(self) -> str:
            clock.spend(1.0)
            self.inner()
            clock.spend(2.0)
            self.inner()
            return "done"

        def inner(self) -> None:
            clock.spend(10.0)

        def breaks(self) -> None:
            clock.spend(5.0)
            raise ValueError("odd")

    before = (Own.outer, Own.inner)
    parts = {"a": [(Own, "outer")], "b": [(Own, "inner"), (Own, "breaks")], "c": []}

    def broken(own: Own) -> None:
        with counters(clock.cpu_ns, parts):
            own.breaks()

    with counters(clock.cpu_ns, parts) as stack:
        assert Own().outer() == "done"
        with pytest.raises(ValueError, match="odd"):
            Own().breaks()
        Own().inner()
    assert {part: ns / 1e9 for part, ns in stack.self_ns.items()} == {"a": 3.0, "b": 35.0, "c": 0.0}
    assert (Own.outer, Own.inner) == before
    with pytest.raises(ValueError, match="odd"):
        broken(Own())
    assert (Own.outer, Own.inner) == before
    assert Stack(clock.cpu_ns, {"x": []}).self_ns == {"x": 0}


def test_a_call_three_deep_is_taken_out_of_each_outer_one_once() -> None:
    """1 s in the outer call, 10 s in the middle one, 100 s in two calls of the inner one."""
    clock = Clock()

    class Own:
        def outer(self) -> None:
            clock.spend(1.0)
            self.middle()

        def middle(self) -> None:
            self.inner()
            clock.spend(10.0)
            self.inner()

        def inner(self) -> None:
            clock.spend(50.0)

    parts = {"a": [(Own, "outer")], "b": [(Own, "middle")], "c": [(Own, "inner")]}
    with counters(clock.cpu_ns, parts) as stack:
        Own().outer()
    found = {part: ns / 1e9 for part, ns in stack.self_ns.items()}
    assert found == {"a": 1.0, "b": 10.0, "c": 100.0}


class Folder:
    """Takes 0.1 s to open, 0.2 s for a row, 0.4 s to close."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock

    def __enter__(self) -> "Folder":
        self._clock.spend(0.1)
        return self

    def __exit__(self, *_: object) -> None:
        self._clock.spend(0.4)

    def files_of(self, run: str) -> str:
        return f"files of {run}"

    def add(self, _result: object) -> None:
        self._clock.spend(0.2)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    """A check takes 1 s, a run 8 s, of which the loop 6 s; it simulates 20 s in 4 cycles."""
    clock = Clock()

    def run_case(_case: Any, _files: Any, *_: Any) -> Any:
        clock.spend(8.0)
        return SimpleNamespace(error=None, sim_s=20.0, loop_s=6.0, frame_log_sha256="ab",
                               series=SimpleNamespace(column=lambda _: range(4)))  # fmt: skip

    monkeypatch.setattr(perf, "prepare", lambda _: clock.spend(1.0))
    monkeypatch.setattr(perf, "run_case", run_case)
    monkeypatch.setattr(profile, "run_case", run_case)
    monkeypatch.setattr(perf, "ResultsWriter", lambda *_, **__: Folder(clock))
    monkeypatch.setattr(perf, "build_manifest", lambda *_, **__: {})
    monkeypatch.setattr(perf, "is_compiled", lambda: True)
    return clock


def test_each_part_of_a_run_is_timed_by_itself(clock: Clock, tmp_path: Path) -> None:
    row = Row(PLAN, "f600", tmp_path, clock)  # type: ignore[arg-type]
    assert row.case.case == "f600"
    found = row.run()
    assert found.prepared_cpu_s == pytest.approx(1.0)
    assert found.cpu_s == pytest.approx(8.7)
    assert found.wall_s == pytest.approx(2 * 8.7)
    assert found.folder_cpu_s == pytest.approx(0.5)
    assert found.factor == pytest.approx(20.0 / 8.7)
    assert found.beyond_simulation_ms == pytest.approx(1e3 * (1.0 + 8.7 - 6.0))
    assert found.next_row_ms == pytest.approx(1e3 * (1.0 + 8.2 - 6.0))
    assert Row(PLAN, None, tmp_path, clock).case.run.startswith("latch_accuracy-")  # type: ignore[arg-type]
    with pytest.raises(UserError, match="no such case") as caught:
        Row(PLAN, "f601", tmp_path, clock)  # type: ignore[arg-type]
    assert "f600" in str(caught.value.allowed)


def test_a_run_in_error_is_not_timed(
    clock: Clock, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(perf, "run_case", lambda *_: SimpleNamespace(error="it broke"))
    with pytest.raises(UserError, match="the case cannot be timed: it broke"):
        Row(PLAN, "f600", tmp_path, clock).run()  # type: ignore[arg-type]


def test_a_measurement_is_of_the_middle_run_and_warm_ones(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first run takes 9 s more; the middle report 3 s, twice as long by the wall."""
    waits = iter([9.0, 0.0, 3.0])
    monkeypatch.setattr(perf, "prepare", lambda _: clock.spend(1.0 + next(waits)))
    reports = iter([3.0, 90.0, 1.0])
    found = measure(PLAN, "f600", 3, clock, lambda _: clock.spend(next(reports)))  # type: ignore[arg-type]
    assert (found["case"], found["repeats"], found["cycles"]) == ("latch_accuracy-f600", 3, 4)
    assert found["wall_s"] == found["wall_s_min"] == pytest.approx(2 * 8.7)
    assert found["real_time_factor"] == pytest.approx(20.0 / 17.4)
    assert found["cpu_factor"] == pytest.approx(20.0 / 8.7)
    assert found["beyond_simulation_ms"] == pytest.approx(1e3 * (1.0 + 1.5 + 2.7))
    assert found["report_s"] == pytest.approx(6.0)
    assert found["cycle_us"] == {"rest": pytest.approx(16e6 / 4)}
    waits = iter([9.0])
    once = measure(PLAN, "f600", 1, clock, lambda _: None)  # type: ignore[arg-type, return-value]
    assert once["beyond_simulation_ms"] == pytest.approx(1e3 * (1.0 + 9.0 + 2.7))


def test_a_measurement_is_shown_with_shares_of_a_cycle() -> None:
    result: dict[str, Any] = {
        "case": "p-a", "simulated_s": 2.0, "wall_s": 0.5, "wall_s_min": 0.4, "wall_s_max": 0.7,
        "repeats": 3, "real_time_factor": 4.0, "cpu_s": 0.25, "cpu_factor": 8.0,
        "beyond_simulation_ms": 12.5, "report_s": 1.25, "compiled": False, "cycles": 2000,
        "cycle_us": {"kernel": 30.0, "rest": 10.0}, "frame_log_sha256": "ab",
        "sources_sha256": "cd",
    }  # fmt: skip
    assert json.loads(show(result, True)) == result
    lines = show(result, False).splitlines()
    assert lines[0].startswith("p-a: 2.000 s simulated in 0.500 s (min 0.400, max 0.700, 3 runs")
    assert lines[1] == "real time factor 4.0"
    assert "CPU time 0.250 s: 8.0 times real time" in lines[2]
    assert lines[2].endswith("a next run takes 12.5 ms beyond its simulation")
    assert lines[3] == "report.html 1.250 s"
    assert "(2000 cycles; " in lines[5]
    assert "read the shares" in lines[5]
    assert lines[6:8] == ["  kernel        30.0    75 %", "  rest          10.0    25 %"]
    assert lines[8:] == ["", "frame_log_sha256 ab", "axisrig interpreted, sources cd"]
    compiled = show({**result, "compiled": True}, False).splitlines()
    assert "only on interpreted modules" in compiled[5]
    assert compiled[-1].startswith("axisrig compiled")


def test_stages_add_up_to_what_is_beside_the_simulation(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 10 and 30 ms: half of it one stage, the simulation beside it, the rest what is left."""
    first, second = [stage for stage in stages.STAGES if stage != stages.SIMULATION][:2]
    made = []

    class OwnRow:
        case = SimpleNamespace(run="p-a")

        def __init__(self, *_: object) -> None:
            self.count = 0
            made.append(self)

        def run(self) -> Timed:
            self.count += 1
            beyond_s = (99.0, 0.01, 0.03)[self.count - 1]
            return Timed(SimpleNamespace(loop_s=0.0), beyond_s, 0.0, 0.0, 0.0)  # type: ignore[arg-type]

    @contextmanager
    def own_counters(_clock: object, parts: Any) -> Iterator[Any]:
        stack = SimpleNamespace(self_ns=dict.fromkeys(parts, 0))
        yield stack
        ms = (0.01, 0.03)[made[0].count - 2] * 1e3
        stack.self_ns |= {first: ms * 0.5e6, second: 1e6, stages.SIMULATION: 500e6}

    monkeypatch.setattr(stages, "Row", OwnRow)
    monkeypatch.setattr(stages, "counters", own_counters)
    found = stages.measure_stages(PLAN, "f600", 2, Clock())  # type: ignore[arg-type]
    assert found["beyond_simulation_ms"] == pytest.approx(20.0)
    assert found["stages_ms"][first] == pytest.approx(10.0)
    assert found["stages_ms"][second] == pytest.approx(1.0)
    assert found["stages_ms"][stages.REST] == pytest.approx(9.0)
    assert stages.SIMULATION not in found["stages_ms"]
    assert made[0].count == 3  # the first one warms
    lines = stages.show_stages(found).splitlines()
    assert f"| {first} | 10.00 |" in lines
    assert "| all of it | 20.00 |" in lines


def test_a_profile_is_for_each_cycle_the_longest_first(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    def entry(code: Any, own_s: float, calls: int) -> Any:
        return SimpleNamespace(code=code, inlinetime=own_s, callcount=calls)

    own = compile("def f(): pass", "/x/axisrig/kernel/channel/a.py", "exec").co_consts[0]
    other = compile("def g(): pass", "/lib/json/decoder.py", "exec").co_consts[0]
    stats = [entry(other, 1e-6, 4), entry(own, 6e-6, 8), entry("<built-in len>", 1e-6, 2)]
    made: Any = SimpleNamespace(
        runcall=lambda function, *given: function(*given), getstats=lambda: stats
    )
    text = profile.profile_row(PLAN, "f600", clock, lambda: made)  # type: ignore[arg-type]
    lines = text.splitlines()
    assert lines[0].startswith("latch_accuracy-f600: 4 cycles, 2.0 us each under the profile")
    assert lines[2].split() == ["1.50", "75.0", "%", "2.00", "kernel.channel.a.f"]
    assert lines[3].split()[0] == "0.25"
    assert {line.split()[-1] for line in lines[3:5]} == {"json.decoder.g", "len"}
    monkeypatch.setattr(profile, "SHOWN", 1)
    assert len(profile.profile_row(PLAN, "f600", clock, lambda: made).splitlines()) == 4  # type: ignore[arg-type]


def own_code(name: str, file: str) -> Any:
    return compile(f"class C:\n def {name}(self): pass", file, "exec").co_consts[0].co_consts[1]


def test_a_profile_is_of_a_warm_bench_and_its_shares_are_of_all_functions(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two of three functions are shown, 30 and 20 of 100 us; the first run is under no profile."""
    ran: list[str] = []
    before = perf.run_case

    def noted(word: str) -> Any:
        return lambda *given: ran.append(word) or before(*given)

    monkeypatch.setattr(perf, "run_case", noted("plain"))
    monkeypatch.setattr(profile, "run_case", noted("profiled"))
    monkeypatch.setattr(profile, "SHOWN", 2)
    own_us = {"b": 20, "c": 10, "d": 10, "e": 10, "f": 10, "g": 10, "a": 30}
    stats = [
        SimpleNamespace(code=f"<{name}>", inlinetime=us * 4e-6, callcount=4)
        for name, us in own_us.items()
    ]
    made: Any = SimpleNamespace(
        runcall=lambda function, *given: function(*given), getstats=lambda: stats
    )
    lines = profile.profile_row(PLAN, "f600", clock, lambda: made).splitlines()  # type: ignore[arg-type]
    assert ran == ["plain", "profiled"]
    assert "4 cycles, 100.0 us each" in lines[0]
    assert [line.split() for line in lines[2:-1]] == [
        ["30.00", "30.0", "%", "1.00", "a"], ["20.00", "20.0", "%", "1.00", "b"],
    ]  # fmt: skip


@pytest.mark.parametrize("series", [None, SimpleNamespace(column=lambda _: ())])
def test_a_profile_of_a_run_without_cycles_is_for_the_whole_run(
    series: Any, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where no function has taken any time."""
    monkeypatch.setattr(profile, "run_case", lambda *_: SimpleNamespace(series=series))
    for own_s, us, share in ((3e-6, "3.00", "100.0"), (0.0, "0.00", "0.0")):
        stats = [SimpleNamespace(code="<len>", inlinetime=own_s, callcount=7)]
        made: Any = SimpleNamespace(
            runcall=lambda function, *given: function(*given), getstats=lambda s=stats: s
        )
        lines = profile.profile_row(PLAN, "f600", clock, lambda m=made: m).splitlines()  # type: ignore[arg-type]
        assert lines[0].startswith("latch_accuracy-f600: 1 cycles, ")
        assert lines[2].split() == [us, share, "%", "7.00", "len"]


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("/x/axisrig/kernel/channel/a.py", "kernel.channel.a.C.f"),
        ("/x/axisrig/bench/axisrig/bench/rig/b.py", "bench.rig.b.C.f"),  # a checkout
        ("/lib/python3/json/decoder.py", "json.decoder.C.f"),
        ("/one.py", "/.one.C.f"),
    ],
)
def test_a_function_is_named_by_its_module_below_the_package(file: str, name: str) -> None:
    assert profile._name(own_code("f", file)) == name
    assert profile._name("<built-in method len>") == "built-in method len"


def test_walls_are_of_the_middle_the_shortest_and_the_longest_run(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Runs of 8, 2 and 5 s beside 0.7 s of the folder; by the wall twice as long."""
    spent_s = iter([8.0, 2.0, 5.0, 1.0])
    names = iter("abcd")

    def run_case(_case: Any, _files: Any, *_: Any) -> Any:
        clock.spend(next(spent_s))
        return SimpleNamespace(error=None, sim_s=20.0, loop_s=1.0, series=None,
                               frame_log_sha256=next(names))  # fmt: skip

    monkeypatch.setattr(perf, "run_case", run_case)
    found = measure(PLAN, "f600", 3, clock, lambda _: None)  # type: ignore[arg-type, return-value]
    walls_s = [found[name] for name in ("wall_s_min", "wall_s", "wall_s_max")]
    assert walls_s == pytest.approx([2 * 2.7, 2 * 5.7, 2 * 8.7])
    assert (found["cpu_s"], found["simulated_s"]) == (pytest.approx(5.7), 20.0)
    # Of the warm ones, 2 and 5 s: 1 s of check and what is beside a loop of 1 s
    assert found["beyond_simulation_ms"] == pytest.approx(1e3 * (1.0 + (2.7 + 5.7) / 2 - 1.0))
    assert found["next_row_ms"] == pytest.approx(1e3 * (1.0 + (2.2 + 5.2) / 2 - 1.0))
    assert (found["cycles"], found["frame_log_sha256"]) == (0, "c")


def test_a_cycle_is_taken_apart_on_a_run_of_its_own_and_what_is_left_is_the_rest(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of 11 s in 4 cycles 3 s are of one part; by the wall twice as long, us of each cycle."""

    class Own:
        def cycle(self) -> None:
            clock.spend(3.0)

    own = Own.cycle
    before = perf.run_case

    def run_case(*words: Any) -> Any:
        Own().cycle()
        return before(*words)

    monkeypatch.setattr(perf, "run_case", run_case)
    monkeypatch.setattr(perf, "is_compiled", lambda: False)
    monkeypatch.setattr(perf, "PARTS", {"kernel": [(Own, "cycle")], "bus": []})
    found = measure(PLAN, "f600", 2, clock, lambda _: None)  # type: ignore[arg-type, return-value]
    parts = {"kernel": 2 * 3e6 / 4, "bus": 0.0, "rest": 2 * 8e6 / 4}
    assert found["cycle_us"] == pytest.approx(parts)
    assert Own.cycle is own
    assert found["cpu_s"] == pytest.approx(11.7)


def test_the_first_row_is_timed_where_none_is_named(
    clock: Clock, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also the first of the runs that a row of several values is; a named one wherever it is."""
    (tmp_path / "part.nc").write_text("N10 M30\n", encoding="utf-8")
    (tmp_path / "rig.toml").write_text("[machine]\n", encoding="utf-8")
    plan = tmp_path / "own.csv"
    cells = "part.nc,rig.toml"
    plan.write_text(
        "case,program,rig,plc:V.E.FEED,check:alarms\n"
        f"slow,{cells},[60 | 70 | 80],none\nfast,{cells},600,none\nlast,{cells},900,none\n",
        encoding="utf-8",
    )
    ran: list[Any] = []
    before = perf.run_case

    def run_case(case: Any, *rest: Any) -> Any:
        ran.append(case)
        return before(case, *rest)

    monkeypatch.setattr(perf, "run_case", run_case)
    runs = [case.run for case in perf.read_plan(plan).cases]
    assert len(runs) == 5
    for name, place in ((None, 0), ("slow", 0), ("fast", 3), ("last", 4)):
        found = measure(plan, name, 1, clock, lambda _: None)  # type: ignore[arg-type, return-value]
        assert (found["case"], {case.run for case in ran}) == (runs[place], {runs[place]})
        assert len(ran) == 2  # timed, and taken apart
        ran.clear()
    with pytest.raises(UserError, match="no such case") as caught:
        Row(plan, "fas", tmp_path, clock)  # type: ignore[arg-type]
    assert caught.value.value == "fas"
    assert caught.value.allowed == "slow, fast, last"  # each once
