"""`axisrig fmu check`: the order of its stages, and what each one finds, without an FMU."""

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import texts
from tests.fmu_tools.trials import CAN

from axisrig.bench.campaign.processes import Died
from axisrig.bench.tools.fmu import check, examine, stages
from axisrig.bench.tools.fmu.check import Checked, check_fmu
from axisrig.bench.tools.fmu.examine import Examined
from axisrig.bench.tools.fmu.findings import Finding, as_rows, fail, has_failed, ok, warn
from axisrig.bench.tools.fmu.stages import Outcome
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError

FMU = Path("a.fmu")


@pytest.mark.parametrize(
    ("findings", "verdict"),
    [
        ([ok("a", "x")], "ok"),
        ([ok("a", "x"), warn("b", "y")], "warn"),
        ([warn("b", "y"), fail("c", "z"), ok("a", "x")], "FAIL"),
    ],
)
def test_a_verdict_is_that_of_the_worst_finding(findings: list[Finding], verdict: str) -> None:
    checked = Checked(FMU, "ab", findings)
    assert (checked.verdict, checked.is_good) == (verdict, verdict != "FAIL")
    data = checked.as_data()
    assert (data["verdict"], data["sha256"], data["file"]) == (verdict, "ab", "a.fmu")
    assert data["findings"] == as_rows(findings)
    assert has_failed(findings) is (verdict == "FAIL")


class Apart:
    """Runs stages: those of `bad` fail, those of `dead` die; `digest` is that of the other run."""

    def __init__(self, patch: pytest.MonkeyPatch, can_run: bool = True) -> None:
        self.bad: set[str] = set()
        self.dead: set[str] = set()
        self.digest = "same"
        self.ran: list[str] = []
        self.limits: list[Any] = []
        self._examined = Examined([ok("archive", "x")], "ab", can_run)
        patch.setattr(check, "run_apart", self._run)
        patch.setattr(check, "_sort_out", lambda _: None)

    def _run(self, function: Any, tasks: Any, **options: Any) -> Any:
        self.limits.append((options.get("call_limit_s"), options.get("timeout_s")))
        for task in tasks:
            if function is examine.examine:
                yield Died("crashed") if "examine" in self.dead else self._examined
                continue
            name = task[0]
            again = options.get("is_unrelated", False)
            self.ran.append(f"{name} again" if again else name)
            if self.ran[-1] in self.dead:
                yield Died("crashed")
            elif name in self.bad:
                yield Outcome([fail(name, "bad")])
            else:
                digest = self.digest if again else "same" if name == "determinism" else ""
                yield Outcome([ok(name, "good")], digest)


ALL = [*stages.FIRST, *stages.REST]


def test_a_good_fmu_goes_through_all_stages_and_once_more_elsewhere(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    apart = Apart(monkeypatch)
    found = check_fmu(FMU, 3.0)
    assert apart.ran == [*ALL, "determinism again"]
    assert texts(found.findings)[-1] == "a run in another process is equal bit for bit"
    assert (found.is_good, found.sha256) == (True, "ab")
    assert apart.limits == [(3.0, None), (3.0, 30.0), (3.0, 30.0), (3.0, 30.0), (3.0, None)]
    apart.digest = "other"
    assert texts(check_fmu(FMU).findings, "FAIL") == ["a run in another process differs"]
    apart.dead = {"determinism again"}
    assert texts(check_fmu(FMU).findings, "FAIL") == ["crashed"]


@pytest.mark.parametrize(
    ("stage", "ran"), [("library", 1), ("call sequence", 2), ("reset", 8), ("roles", 8)]
)
@pytest.mark.parametrize("way", ["bad", "dead"])
def test_what_has_failed_is_not_tried_any_further(
    stage: str, ran: int, way: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    apart = Apart(monkeypatch)
    setattr(apart, way, {stage})
    found = check_fmu(FMU)
    assert apart.ran == ALL[:ran]
    (failed,) = [one for one in found.findings if one.level == "FAIL"]
    assert (failed.area, failed.text) == (stage, "bad" if way == "bad" else "crashed")
    # What else was tried at the same time is reported too
    assert [one.area for one in found.findings] == ["archive", *ALL[:ran]]


def test_what_cannot_run_is_not_run(monkeypatch: pytest.MonkeyPatch) -> None:
    apart = Apart(monkeypatch, can_run=False)
    assert texts(check_fmu(FMU).findings) == ["x"]
    apart.dead = {"examine"}
    found = check_fmu(FMU)
    assert texts(found.findings, "FAIL") == ["reading it: crashed"]
    assert (apart.ran, found.sha256) == ([], "")


def level(outcome: Outcome) -> list[str]:
    return [one.level for one in outcome.findings]


def test_two_runs_must_be_equal(fake: Any) -> None:
    fake()
    good = stages.determinism(FMU)
    assert (level(good), len(good.digest)) == (["ok"], 64)
    assert texts(good.findings) == ["two runs of 100 steps are equal bit for bit"]
    fake(odd=staticmethod(lambda one, count: 0.5 * (one.name == "two" and count == 7)))
    bad = stages.determinism(FMU)
    assert texts(bad.findings) == ["two runs differ: x at t = 7 ms is 7.0 and 7.5"]
    assert bad.digest == good.digest  # that of the first run
    fake(odd=staticmethod(lambda one, count: 0.5 * (count == 0)))
    assert stages.determinism(FMU).digest != good.digest


def test_a_run_after_reset_must_be_equal(fake: Any) -> None:
    fake()
    assert level(stages.reset(FMU)) == ["ok"]
    fake(odd=staticmethod(lambda one, count: 0.5 * (hasattr(one, "was_reset") and count == 100)))
    assert texts(stages.reset(FMU).findings) == [
        "a run after reset differs: x at t = 100 ms is 100.0 and 100.5"
    ]

    def refuse(_: object) -> None:
        raise RuntimeError("no reset")

    fake(reset=refuse)
    assert texts(stages.reset(FMU).findings, "warn") == ["refuses: no reset"]


def test_a_state_must_come_back_twice(fake: Any) -> None:
    fake()
    assert texts(stages.state(FMU).findings) == ["restored, the run is equal bit for bit"]
    fake(odd=staticmethod(lambda one, count: 0.5 * (one.restores == 2 and count > 40)))
    found = stages.state(FMU).findings
    assert [one.level for one in found] == ["ok", "FAIL"]
    assert "x at t = 41 ms" in found[1].text
    fake(can=SimpleNamespace(**{**CAN, "can_save_state": False}))
    assert stages.state(FMU).findings == []


def test_instances_must_not_know_of_each_other(fake: Any) -> None:
    for name, count, is_good in (("one", 60, False), ("two", 3, False), ("two", 97, False),
                                 ("trial", 1000, True)):  # fmt: skip
        made = fake(
            odd=staticmethod(lambda one, at, n=name, c=count: 0.5 * (one.name == n and at == c))
        )
        assert level(stages.instances(FMU)) == ["ok" if is_good else "FAIL"], (name, count)
        assert made.made == ["trial", "one", "two"]
    made = fake(can=SimpleNamespace(**{**CAN, "once_per_process": True}))
    assert texts(stages.instances(FMU).findings) == ["one only, as its description says"]
    assert made.made == ["trial"]


def test_steps_that_are_refused_are_named_and_the_others_too(fake: Any) -> None:
    fake()
    assert texts(stages.steps(FMU).findings) == ["takes 1 ms, 0.25 ms, 0.05 ms, mixed lengths"]
    fake(refuses_ns=(250_000,))
    found = stages.steps(FMU).findings
    assert texts(found, "warn") == ["refuses steps of 0.25 ms: no such step"]
    assert texts(found, "ok") == ["takes 1 ms, 0.05 ms, mixed lengths"]
    fake(can=SimpleNamespace(**{**CAN, "can_vary_step": False}))
    assert texts(stages.steps(FMU).findings) == ["takes 1 ms, 0.25 ms, 0.05 ms"]
    for step_s, is_long in ((250e-6, False), (251e-6, True)):
        fake(can=SimpleNamespace(**{**CAN, "fixed_step_s": step_s}))
        assert bool(texts(stages.steps(FMU).findings, "warn")) is is_long


def test_a_run_of_the_calls_says_what_it_left(fake: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    made = fake()
    assert texts(stages.sequence(FMU).findings) == ["100 steps of 1 ms, terminated, freed"]
    assert made.made == ["trial"]
    fake(ends_after=40)
    found = stages.sequence(FMU).findings
    assert texts(found, "ok") == ["40 steps of 1 ms, terminated, freed"]
    assert texts(found, "warn") == ["it ended the simulation by itself after t = 40 ms"]
    for count in (0, 100):  # at the begin, or at the end
        fake(odd=staticmethod(lambda _, at, c=count: math.inf if at == c else 0.0))
        assert texts(stages.sequence(FMU).findings, "warn") == [
            "outputs that are no finite number: x"
        ]
    fake(messages=[SimpleNamespace(text="first"), SimpleNamespace(text="second")])
    assert texts(stages.sequence(FMU).findings, "warn") == ["2 messages, the first: first"]
    fake()
    monkeypatch.setattr(stages, "printed_lines", lambda: ["hello", "you"])
    assert texts(stages.sequence(FMU).findings, "warn") == [
        "2 lines on standard output, the first: hello"
    ]


def test_what_the_process_shares_is_compared() -> None:
    before: dict[str, object] = {"working folder": "/a", "arithmetic": True}
    assert list(stages._changes(before, dict(before))) == []
    (moved,) = stages._changes(before, {**before, "working folder": "/b"})
    assert (moved.level, moved.text) == ("warn", "it changes the working folder of the process")
    (fast,) = stages._changes(before, {**before, "arithmetic": False})
    assert (fast.level, "denormal numbers" in fast.text) == ("FAIL", True)
    assert stages._has_plain_arithmetic()


def test_what_a_stage_raises_is_a_finding(monkeypatch: pytest.MonkeyPatch) -> None:
    for error, text in (
        (UserError("no library", hint="build it"), "no library"),
        (PlantError("trial", 2_500_000, "bad status"), "at t = 2.5 ms: bad status"),
        (RuntimeError("odd"), "odd"),
        (RuntimeError(), "RuntimeError"),
    ):

        def breaks(_: Path, error: Exception = error) -> Outcome:
            raise error

        monkeypatch.setitem(stages.FIRST, "library", breaks)
        (found,) = stages.run_stage("library", FMU).findings
        assert (found.area, found.level, found.text) == ("library", "FAIL", text)
    monkeypatch.setitem(stages.REST, "reset", lambda path: Outcome([ok("reset", str(path))]))
    assert texts(stages.run_stage("reset", FMU).findings) == ["a.fmu"]
