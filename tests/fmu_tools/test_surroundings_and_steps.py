"""What an FMU leaves in its process, and which steps it is tried with (docs/fmus.md): no FMU."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import texts
from tests.fmu_tools.trials import CAN, FakeTrial

from axisrig.bench.tools.fmu import stages
from axisrig.bench.tools.fmu.findings import Finding, warn
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

FMU = Path("a.fmu")
VARYING = SimpleNamespace(**CAN)
NOT_VARYING = SimpleNamespace(**{**CAN, "can_vary_step": False})


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda patch, folder: patch.chdir(folder), "working folder"),
        (lambda patch, _: patch.setenv("TOOL_OF_THE_FMU", "on"), "environment"),
        (lambda patch, _: patch.setenv("THERE_BEFORE", "other"), "environment"),
        (lambda patch, _: patch.delenv("THERE_BEFORE"), "environment"),
        (
            lambda patch, _: patch.setattr(
                stages.locale, "localeconv", lambda: {"decimal_point": ","}
            ),
            "locale of numbers",
        ),
    ],
)
def test_each_thing_that_an_fmu_changes_in_its_process_is_named_alone(
    change: Any, what: str, fake: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("THERE_BEFORE", "one")
    fake(prepare=staticmethod(lambda _: change(monkeypatch, tmp_path)))
    found = stages.sequence(FMU).findings
    assert [one.level for one in found] == ["ok", "warn"]
    assert (found[1].area, found[1].text) == (
        "call sequence",
        f"it changes the {what} of the process",
    )
    assert found[1].remedy == "its case alone feels it"
    fake()
    assert texts(stages.sequence(FMU).findings, "warn") == []  # the next one finds it so


def test_an_fmu_that_switches_the_arithmetic_of_its_process_fails(
    fake: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As a library that is linked with -ffast-math does: also where it comes back afterwards."""
    plain = [True]
    monkeypatch.setattr(stages, "_has_plain_arithmetic", lambda: plain[0])
    fake(prepare=staticmethod(lambda _: plain.__setitem__(0, False)))
    found = stages.sequence(FMU).findings
    assert [one.level for one in found] == ["ok", "FAIL"]
    assert "-ffast-math" in found[1].remedy
    assert texts(stages.sequence(FMU).findings, "FAIL") == []  # it was so before this one


class Recorded:
    """Trials of fakes: whether inputs move, and the lengths of each run."""

    def __init__(self, fake: Any, **given: Any) -> None:
        self.moves: list[bool] = []
        self.runs: list[list[int]] = []

        def run(trial: FakeTrial, lengths: Any) -> Any:
            self.runs.append(list(lengths))
            return FakeTrial.run(trial, lengths)

        fake(prepare=staticmethod(lambda trial: self.moves.append(trial.moves)), run=run, **given)


def test_a_run_of_the_calls_leaves_the_inputs_and_all_other_trials_move_them(fake: Any) -> None:
    """Outputs follow something only where inputs move; the plain calls are those of any rig."""
    found = Recorded(fake)
    stages.sequence(FMU)
    assert found.moves == [False]
    for stage in (stages.steps, stages.determinism, stages.reset, stages.state, stages.instances):
        found = Recorded(fake)
        stage(FMU)
        assert found.moves, stage.__name__
        assert all(found.moves), stage.__name__


def test_steps_of_the_bench_are_taken_each_a_hundred_times(fake: Any) -> None:
    found = Recorded(fake, can=NOT_VARYING)
    stages.steps(FMU)
    assert found.runs == [[MS] * 100, [250 * US] * 100, [50 * US] * 100]


@pytest.mark.parametrize(
    ("own_ns", "parts_ns"),
    [
        (2 * MS, [2_000_000, 666_666, 2_000_000, 200_000, 285_714]),
        (9, [9, 3, 9, 1, 1]),  # the tenth part is none of 0 ns
    ],
)
def test_mixed_lengths_are_parts_of_the_own_step_and_twice_it(
    own_ns: int, parts_ns: list[int], fake: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The whole, a third, the whole, a tenth, a seventh, over and over; then twice the whole."""
    found = Recorded(fake, can=VARYING)
    monkeypatch.setattr(stages, "step_of", lambda _: own_ns)
    assert texts(stages.steps(FMU).findings, "ok")[0].endswith("mixed lengths")
    mixed = found.runs[-1]
    half = len(mixed) // 2
    assert mixed[:half] == parts_ns * (half // 5)
    assert mixed[half:] == [2 * own_ns] * half
    assert half >= 10


def test_an_fmu_that_takes_no_step_has_a_line_for_each_and_no_other(fake: Any) -> None:
    fake(can=NOT_VARYING, refuses_ns=stages.BENCH_STEPS_NS)
    found = stages.steps(FMU).findings
    assert texts(found) == [
        f"refuses steps of {words}: no such step" for words in ("1 ms", "0.25 ms", "0.05 ms")
    ]
    assert {one.level for one in found} == {"warn"}
    assert all("exchange_us" in one.remedy for one in found)


@pytest.mark.parametrize(
    ("fixed_s", "inner_ns"), [(None, 0), (2.5e-3, 2_500_000), (1e-4, 100_000), (0.3e-9, 0)]
)
def test_courses_are_judged_by_the_fixed_step_of_the_fmu(
    fixed_s: float | None, inner_ns: int, fake: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not by the one that it proposes, 1 ms here; what they find is between the steps and it."""
    given: list[tuple[Path, int]] = []

    def courses(path: Path, own_ns: int) -> list[Finding]:
        given.append((path, own_ns))
        return [warn("steps", "of a course")]

    fake(can=SimpleNamespace(**{**CAN, "fixed_step_s": fixed_s}))
    monkeypatch.setattr(stages, "course_findings", courses)
    found = texts(stages.steps(FMU).findings)
    assert given == [(FMU, inner_ns)]
    assert found[:2] == ["takes 1 ms, 0.25 ms, 0.05 ms, mixed lengths", "of a course"]
    long = ["its own step of 2.5 ms is longer than those of the bench"]
    assert found[2:] == (long if inner_ns == 2_500_000 else [])


@pytest.mark.parametrize(
    ("error", "remedy"),
    [
        (UserError("no library", hint="build it"), "build it"),
        (UserError("no library"), ""),
        (PlantError("trial", 2 * MS, "bad"), "see what the FMU says; set its start values"),
        (RuntimeError("odd"), ""),
    ],
)
def test_what_a_stage_raises_keeps_what_to_do(
    error: Exception, remedy: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def breaks(_: Path) -> Any:
        raise error

    for area, group in (("call sequence", stages.FIRST), ("instances", stages.REST)):
        monkeypatch.setitem(group, area, breaks)
        (found,) = stages.run_stage(area, FMU).findings
        assert (found.area, found.level, found.remedy) == (area, "FAIL", remedy)


def test_a_run_that_ends_at_once_has_the_outputs_of_its_start(fake: Any) -> None:
    fake(ends_after=0, odd=staticmethod(lambda *_: float("nan")))
    found = stages.sequence(FMU).findings
    assert texts(found) == [
        "0 steps of 1 ms, terminated, freed",
        "it ended the simulation by itself after t = 0 ms",
        "outputs that are no finite number: x",
    ]
    assert [one.level for one in found] == ["ok", "warn", "warn"]


def test_of_many_outputs_without_a_number_six_are_named(fake: Any) -> None:
    names = [f"y{number}" for number in range(1, 9)]

    def read(trial: FakeTrial) -> Any:
        values = tuple((float("inf"),) for _ in names)
        return stages.Reading(trial.slave.time_ns, b"", values)

    fake(outputs=[SimpleNamespace(name=name) for name in names], read=read)
    (found,) = texts(stages.sequence(FMU).findings, "warn")
    assert found == "outputs that are no finite number: y1, y2, y3, y4, y5, y6"


def test_a_trial_is_freed_whatever_happens_in_it(fake: Any) -> None:
    freed: list[str] = []
    own = {"close": lambda trial: freed.append(trial.name)}
    fake(refuses_ns=stages.BENCH_STEPS_NS, can=NOT_VARYING, **own)
    stages.steps(FMU)
    assert freed == ["trial"] * 4  # one for the step, three that are refused
    freed.clear()
    fake(**own)
    stages.instances(FMU)
    assert sorted(freed) == ["one", "trial", "two"]
    freed.clear()
    fake(refuses_ns=(MS,), **own)
    for stage in (stages.sequence, stages.determinism, stages.reset, stages.state):
        with pytest.raises(PlantError):
            stage(FMU)
    assert freed == ["trial", "one", "trial", "trial"]
