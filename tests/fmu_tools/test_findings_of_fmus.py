"""What is found about FMUs, from descriptions and trials that are written down here."""

import hashlib
import math
from collections import deque
from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.processes import Died
from axisrig.bench.tools.fmu import check, examine, library, place, release, stages, trial
from axisrig.bench.tools.fmu.check import Checked, check_fmu
from axisrig.bench.tools.fmu.examine import Examined
from axisrig.bench.tools.fmu.findings import Finding, as_rows, fail, has_failed, ok, warn
from axisrig.bench.tools.fmu.release import Change
from axisrig.bench.tools.fmu.stages import Outcome
from axisrig.bench.tools.fmu.trial import Reading, first_difference, not_finite, step_of
from axisrig.fmus import MODELS, PLATFORMS
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

FMU = Path("a.fmu")


def texts(findings: Iterable[Finding], level: str = "") -> list[str]:
    return [one.text for one in findings if level in ("", one.level)]


# The worst counts


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


def test_what_cannot_run_is_not_run(monkeypatch: pytest.MonkeyPatch) -> None:
    apart = Apart(monkeypatch, can_run=False)
    assert texts(check_fmu(FMU).findings) == ["x"]
    apart.dead = {"examine"}
    found = check_fmu(FMU)
    assert texts(found.findings, "FAIL") == ["reading it: crashed"]
    assert (apart.ran, found.sha256) == ([], "")


# Trials


class Slave(SimpleNamespace):
    """An instance."""


class FakeTrial:
    """Outputs follow the number of steps; `odd`: what changes them, by the name of the instance."""

    made: list[str]
    outputs: Any = (SimpleNamespace(name="x"),)

    def __init__(self, _path: Path, name: str = "trial", *, moves: bool = False) -> None:
        type(self).made.append(name)
        self.name, self.count, self.moves = name, 0, moves
        self.slave: Any = Slave(
            description=None, can=self.can, messages=list(self.messages), time_ns=0,
            save_state=lambda: Slave(handle=1, time_ns=self.slave.time_ns, count=self.count),
            restore_state=self._restore, fmpy=None,
        )  # fmt: skip

    can: Any = None
    messages: Any = ()
    ends_after = 10**6
    refuses_ns: Any = ()
    odd: Any = staticmethod(lambda trial, count: 0.0)
    restores = 0

    def start(self) -> None:
        self.slave.time_ns = self.count = 0

    def close(self) -> None: ...

    def reset(self) -> None:
        self.was_reset = True

    def _restore(self, saved: Any) -> None:
        self.slave.time_ns, self.count = saved.time_ns, saved.count
        self.restores += 1

    def read(self) -> Reading:
        value = (float(self.count) + self.odd(self, self.count),)
        return Reading(self.slave.time_ns, repr(value).encode(), (value,))

    def run(self, lengths: Any) -> list[Reading]:
        found = []
        for step_ns in lengths:
            if step_ns in self.refuses_ns:
                raise PlantError(self.name, self.slave.time_ns, "no such step")
            if self.count >= self.ends_after:
                break
            self.count += 1
            self.slave.time_ns += step_ns
            found.append(self.read())
        return found


CAN: dict[str, Any] = {"can_save_state": True, "can_serialize_state": False, "can_vary_step": True,
       "once_per_process": False, "fixed_step_s": None}  # fmt: skip


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Give trials these properties."""

    def given(**properties: Any) -> type[FakeTrial]:
        own = {"can": SimpleNamespace(**CAN), "made": []}
        made = type("Own", (FakeTrial,), {**own, **properties})
        monkeypatch.setattr(stages, "Trial", made)
        return made

    monkeypatch.setattr(stages, "step_of", lambda _: MS)
    monkeypatch.setattr(stages, "course_findings", lambda *_: [])
    monkeypatch.setattr(stages, "printed_lines", list)
    return given


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


# Readings


def reading(ms: int, *values: Any) -> Reading:
    bits = b"\0".join(trial._bits(value) for value in values)
    return Reading(ms * MS, bits, values)


OUTPUTS: Any = [SimpleNamespace(name=name) for name in ("a", "b")]


def test_runs_are_compared_bit_for_bit() -> None:
    same = [reading(0, (1.0,), (True,)), reading(1, (2.0,), (False,))]
    assert first_difference(same, list(same), OUTPUTS) is None
    for other, words in (
        ([same[0]], "one ends itself after 2 steps, the other after 1"),
        ([same[0], reading(1, (2.0,), (True,))], "b at t = 1 ms is False and True"),
        ([reading(0, (-1.0,), (True,)), same[1]], "a at t = 0 ms is 1.0 and -1.0"),
    ):
        assert first_difference(same, other, OUTPUTS) == words
    zero, minus = ([reading(0, (sign * 0.0,), (1,))] for sign in (1, -1))
    assert first_difference(zero, minus, OUTPUTS) == "a at t = 0 ms is 0.0 and -0.0"
    assert first_difference([reading(0, (math.nan,), (1,))], [reading(0, (math.nan,), (1,))],
                            OUTPUTS) is None  # fmt: skip
    long = [[reading(0, tuple(float(k + n) for k in range(30)), (1,))] for n in (0, 1)]
    assert str(first_difference(*long, OUTPUTS)).endswith("...")


def test_numbers_that_are_not_finite_are_named() -> None:
    for values, names in (
        (((1.0,), (2,)), []), (((math.inf,), (2,)), ["a"]), (((1.0,), (math.nan, 1.0)), ["b"]),
        (((-math.inf,), (math.nan,)), ["a", "b"]),
    ):  # fmt: skip
        assert not_finite(reading(0, *values), OUTPUTS) == names


@pytest.mark.parametrize(
    ("experiment", "fixed", "step_ns"),
    [
        ("0.002", "0.001", 2 * MS),
        (None, "0.0005", 500_000),
        ("nan", "0.0005", 500_000),
        ("0", None, trial.DEFAULT_STEP_NS),
        ("1e-10", None, trial.DEFAULT_STEP_NS),
        ("1e-9", None, 1),
        ("inf", "inf", trial.DEFAULT_STEP_NS),
        ("-1", None, trial.DEFAULT_STEP_NS),
    ],
)
def test_the_step_is_that_of_the_experiment_then_the_inner_one(
    experiment: str | None, fixed: str | None, step_ns: int
) -> None:
    description: Any = SimpleNamespace(
        defaultExperiment=None if experiment is None else SimpleNamespace(stepSize=experiment),
        coSimulation=SimpleNamespace(fixedInternalStepSize=fixed),
    )
    assert step_of(description) == step_ns


def variable(name: str, **given: Any) -> Any:
    known = {"type": "Float64", "causality": "input", "start": None, "min": None, "max": None,
             "shape": (), "clocks": [], "dimensions": [], "variability": "continuous"}  # fmt: skip
    return SimpleNamespace(name=name, **{**known, **given})


def test_inputs_move_within_their_limits_and_flags_change_once() -> None:
    description: Any = SimpleNamespace(
        modelVariables=[
            variable("plain"), variable("large", start="-2000"),
            variable("low", start="0", min="0"), variable("high", start="0", max="0.0005"),
            variable("flag", type="Boolean", start="true"), variable("off", type="Boolean"),
            variable("array", shape=(3,)), variable("clocked", clocks=["c"]),
            variable("out", causality="output"), variable("whole", type="Int32"),
        ]
    )  # fmt: skip

    def moved(count: int) -> dict[str, Any]:
        return {one.name: value for one, value in trial._moved_inputs(description, count)}

    assert moved(0) == {"plain": 0.0, "large": -2000.0, "low": 0.0, "high": 0.0, "flag": True,
                        "off": False}  # fmt: skip
    second = moved(2)
    assert second["plain"] == pytest.approx(2e-3)
    assert second["large"] == pytest.approx(-2000 + 4.0)
    assert (second["low"], second["high"]) == (pytest.approx(2e-3), 0.0005)
    assert moved(6)["low"] == 0.0
    assert moved(6)["plain"] == pytest.approx(-2e-3)
    assert moved(8) == moved(0)
    assert (moved(9)["flag"], moved(9)["off"]) == (True, False)
    assert (moved(10)["flag"], moved(10)["off"]) == (False, True)


# Descriptions


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"start": "1"}, None),
        ({"start": "1", "min": "1", "max": "1"}, None),
        ({"start": "0.5", "min": "1"}, "v = 0.5 (1 .. inf)"),
        ({"start": "2", "max": "1"}, "v = 2 (-inf .. 1)"),
        ({"start": "1 5 2", "max": "3"}, "v = 5 (-inf .. 3)"),
        ({"start": "2", "max": "1", "causality": "local"}, None),
        ({"start": "2", "max": "1", "type": "String"}, None),
        ({"max": "1"}, None),
        ({"start": "2", "max": "1", "type": "UInt8"}, "v = 2 (-inf .. 1)"),
    ],
)
def test_a_start_value_outside_its_limits_is_named(given: dict[str, Any], text: str | None) -> None:
    assert examine._out_of_range(variable("v", **given)) == text


def test_of_many_names_six_are_shown() -> None:
    names = [f"v{n}" for n in range(8)]
    assert examine._some(names[:6]) == "v0, v1, v2, v3, v4, v5"
    assert examine._some(names) == "v0, v1, v2, v3, v4, v5 and 2 more"


@pytest.mark.parametrize(
    ("units", "warnings", "good"),
    [
        ({"a": "m", "b": "m/s"}, [], ["known: m, m/s"]),
        ({}, [], ["nothing has one"]),
        ({"a": "m", "b": None}, ["without a unit: b"], []),
        ({"a": "furlong", "b": None}, ["units not known: furlong", "without a unit: b"], []),
    ],
)
def test_units_of_inputs_and_outputs_are_looked_at(
    units: dict[str, str | None], warnings: list[str], good: list[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr(examine, "unit_name", lambda v: units.get(v.name))
    monkeypatch.setattr(examine, "find_unit", lambda _, name: None if name == "furlong" else name)
    beside = [variable("c", causality="local"), variable("d", type="Boolean")]
    found = list(examine._units(None, [*map(variable, units), *beside]))  # type: ignore[arg-type]
    assert (texts(found, "warn"), texts(found, "ok")) == (warnings, good)


@pytest.mark.parametrize("missing", ["", "vary", "tool", "once", "state"])
def test_each_capability_that_is_missing_is_a_warning(
    missing: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    can = SimpleNamespace(
        can_save_state=missing != "state", can_serialize_state=False, can_return_early=True,
        can_vary_step=missing != "vary", needs_tool=missing == "tool",
        once_per_process=missing == "once",
    )  # fmt: skip
    monkeypatch.setattr(examine, "Capabilities", SimpleNamespace(of=lambda *_: can))
    said, *warnings = examine._capabilities(None, FMU)  # type: ignore[arg-type]
    assert said.text == (
        f"saves its state: {'no' if missing == 'state' else 'yes'}; serialises it: no; returns"
        f" early: yes; takes steps of any length: {'no' if missing == 'vary' else 'yes'}"
    )
    words = {"vary": "one length only", "tool": "needs the tool", "once": "once in a process",
             "state": "cannot be saved"}  # fmt: skip
    assert len(warnings) == bool(missing)
    assert all(words[missing] in one.text and one.level == "warn" for one in warnings)


# To hand on


def test_a_course_is_written_before_and_after_each_change() -> None:
    inputs: Any = [variable("x", start="0.5"), variable("on", type="Boolean", start="true"),
                   variable("n", type="Int32", start="3")]  # fmt: skip
    course = [Change(0.0, "x", 1.0), Change(0.2, "n", 4.0), Change(0.2, "on", 0.0)]
    rows = list(release._input_rows(inputs, course, 0.0, 1.0))
    assert rows == [[0.0, 1.0, 1, 3], [0.2, 1.0, 1, 3], [0.2, 1.0, 0, 4], [1.0, 1.0, 0, 4]]
    assert list(release._input_rows(inputs, [], 0.0, 1.0)) == [[0.0, 0.5, 1, 3], [1.0, 0.5, 1, 3]]
    late = list(release._input_rows(inputs, [Change(0.1, "x", 2.0)], 0.05, 1.0))
    assert late == [[0.05, 0.5, 1, 3], [0.1, 0.5, 1, 3], [0.1, 2.0, 1, 3], [1.0, 2.0, 1, 3]]
    early = list(release._input_rows(inputs, [Change(0.0, "x", 2.0)], 0.05, 1.0))
    assert early == [[0.05, 2.0, 1, 3], [1.0, 2.0, 1, 3]]


def test_a_change_acts_from_the_first_point_that_is_not_before_it() -> None:
    given: list[tuple[str, float]] = []

    def set_start(name: str, value: float) -> None:
        given.append((name, value))

    slave: Any = SimpleNamespace(variable=variable, set_start=set_start)
    waiting = deque([Change(0.0, "a", 1.0), Change(0.002, "b", 2.0), Change(0.0021, "c", 3.0)])
    came = []
    for ms in (0, 1, 2, 3):
        release._apply(slave, waiting, ms * MS)
        came.append(len(given))
    assert came == [1, 1, 2, 3]
    assert given == [("a", 1.0), ("b", 2.0), ("c", 3.0)]


def test_sums_are_of_every_file_but_themselves(tmp_path: Path) -> None:
    for name in ("b/x.fmu", "a.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(name, encoding="utf-8")
    for _ in range(2):
        path = release.write_sums(tmp_path)
        assert path.read_text(encoding="utf-8").splitlines() == [
            f"{hashlib.sha256(name.encode()).hexdigest()}  {name}" for name in ("a.csv", "b/x.fmu")
        ]
    release._write_csv(tmp_path / "v.csv", ["time", "x.y"], [[0.1 + 0.2, 1], [1e-9, 0]])
    assert (tmp_path / "v.csv").read_text(encoding="utf-8") == (
        '"time","x.y"\n0.30000000000000004,1\n1e-09,0\n'
    )


def test_courses_of_models_are_in_the_order_of_time() -> None:
    known = release.courses()
    assert set(known) <= set(MODELS)
    for changes in known.values():
        assert [one.at_s for one in changes] == sorted(one.at_s for one in changes)


# The library


def test_models_and_platforms_are_meant_by_their_words() -> None:
    name = next(name for name in MODELS if name.endswith(".TouchProbe"))
    assert library.named("TouchProbe") == library.named(name) == [name]
    assert library.named("touchprobe") == []
    every = [one.name for one in PLATFORMS.values() if one.in_all]
    first = next(iter(PLATFORMS))
    assert library.chosen_platforms(["all", first]) == every
    assert library.chosen_platforms([first, first]) == [first]
    assert library.chosen_platforms([]) == []


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"model": "TouchProb"}, "the library has no such model"),
        ({"fmi": ["1.0"]}, "no such FMI version"),
        ({"platforms": ["solaris"]}, "no such platform"),
        ({"compiler": "tcc"}, "no such compiler"),
    ],
)
def test_a_word_that_the_library_does_not_know_is_refused_before_anything_is_built(
    given: dict[str, Any], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(library, "_built", lambda *_: pytest.fail("it is built"))
    with pytest.raises(UserError, match=message) as caught:
        list(library.build_models(**{"model": None, **given}))
    assert caught.value.allowed


def test_only_what_the_cache_lacks_is_built_and_all_come_in_their_order(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []

    def run_apart(_function: object, tasks: Any, **_: object) -> Any:
        asked.extend((task[0], task[2]) for task in tasks)
        return iter([Path(f"/new/{task[0]}-{task[2]}") for task in tasks])

    monkeypatch.setattr(library, "MODELS", ("L.a", "L.b", "L.c"))
    monkeypatch.setattr(
        library, "place_in_cache", lambda name, _p, fmi, *_: Path(f"/old/{name}-{fmi}")
    )
    monkeypatch.setattr(library, "is_ours", lambda path: path.name in ("L.b-3.0", "L.a-2.0"))
    monkeypatch.setattr(library, "run_apart", run_apart)
    found = [str(one.path) for one in library.build_models(None, ["3.0", "2.0", "3.0"])]
    assert found == ["/new/L.a-3.0", "/old/L.b-3.0", "/new/L.c-3.0",
                     "/old/L.a-2.0", "/new/L.b-2.0", "/new/L.c-2.0"]  # fmt: skip
    assert asked == [("L.a", "3.0"), ("L.c", "3.0"), ("L.b", "2.0"), ("L.c", "2.0")]
    monkeypatch.setattr(library, "run_apart", lambda *_, **__: iter([Died("no memory")]))
    with pytest.raises(UserError, match=r"L\.a cannot be built: no memory"):
        list(library.build_models("a"))


def test_an_fmu_is_a_file_a_model_or_a_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(place, "own_fmu", lambda path: Path(f"built of {path}"))
    monkeypatch.setattr(place, "library_fmu", lambda name: Path(f"library {name}"))
    monkeypatch.setattr(place, "named", lambda text: {"One": ["L.One"], "Two": ["A.Two", "B.Two"]}
                        .get(text, []))  # fmt: skip
    there = tmp_path / "a file"
    there.touch()
    for text, found in (
        ("m.mo", "built of m.mo"), ("gone.fmu", "gone.fmu"), (str(there), str(there)),
        ("One", "library L.One"),
    ):  # fmt: skip
        assert str(place.find_fmu(text)) == found
    for text in ("Two", "Three"):
        with pytest.raises(UserError, match="neither an FMU file nor a model") as caught:
            place.find_fmu(text)
        assert ("A.Two, B.Two" in str(caught.value.allowed)) is (text == "Two")
