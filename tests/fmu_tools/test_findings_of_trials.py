"""What a finding of a trial says: its area, what to do, whose step; instances in turns; no FMU."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmu_tools.described import texts, variable
from tests.fmu_tools.test_courses_of_steps import findings as course_of
from tests.fmu_tools.test_courses_of_steps import held
from tests.fmu_tools.test_fmu_check_stages import ALL, Apart
from tests.fmu_tools.test_fmu_release_folder import Exchange, Slave
from tests.fmu_tools.test_libraries_and_states import FMI3, library
from tests.fmu_tools.trials import CAN, FakeTrial

from axisrig.bench.tools.fmu import courses, release, stages
from axisrig.bench.tools.fmu.check import Checked, check_fmu
from axisrig.bench.tools.fmu.findings import fail, ok, warn
from axisrig.bench.tools.fmu.release import Change
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US

FMU = Path("a.fmu")


def test_data_of_a_check_have_the_whole_path_and_the_whole_sum() -> None:
    path, digest = Path("models") / "press" / "a.fmu", "0123456789abcdef" * 4
    found = [ok("archive", "x"), warn("units", "y", "do it"), fail("state", "z")]
    assert Checked(path, digest, found).as_data() == {
        "file": str(path), "sha256": digest, "verdict": "FAIL",
        "findings": [
            {"area": "archive", "level": "ok", "text": "x", "remedy": ""},
            {"area": "units", "level": "warn", "text": "y", "remedy": "do it"},
            {"area": "state", "level": "FAIL", "text": "z", "remedy": ""},
        ],
    }  # fmt: skip


@pytest.mark.parametrize(
    ("digest", "dead", "level"),
    [("same", False, "ok"), ("other", False, "FAIL"), ("same", True, "FAIL")],
)
def test_a_run_in_another_process_is_a_finding_about_repeatability(
    digest: str, dead: bool, level: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After those of all trials; where it differs the remedy says why that may be."""
    apart = Apart(monkeypatch)
    apart.digest = digest
    apart.dead = {"determinism again"} if dead else set()
    found = check_fmu(FMU).findings
    assert [one.area for one in found] == ["archive", *ALL, "repeatability"]
    assert found[-1].level == level
    assert ("a clock or a random number" in found[-1].remedy) is (digest == "other")


def test_what_a_library_lacks_is_exported_again(fake: Any) -> None:
    library(fake, "fmi3", FMI3[1:], b"3.0", can_save_state=False)
    (found,) = stages.load(FMU).findings
    assert (found.area, found.level, found.remedy) == ("library", "FAIL", "export it again")
    library(fake, "fmi3", FMI3, b"2.0", can_save_state=False)
    assert [one.remedy for one in stages.load(FMU).findings] == ["", "export it again"]


@pytest.mark.parametrize(
    ("off", "level", "words"),
    [(1e-9, "warn", "edges are searched"), (1.0, "FAIL", "cannot be searched")],
)
def test_a_state_that_does_not_come_back_says_what_that_means(
    fake: Any, off: float, level: str, words: str
) -> None:
    fake(odd=staticmethod(lambda trial, count: off * (trial.restores > 0 and count == 40)))
    (found,) = stages.state(FMU).findings
    assert found.level == level
    assert words in found.remedy
    assert ("canGetAndSetFMUState" in found.remedy) is (level == "FAIL")


@pytest.mark.parametrize(("own_ns", "words"), [(2 * MS, "2"), (125 * US, "0.125"), (50 * MS, "50")])
def test_a_run_of_the_calls_has_the_step_that_the_fmu_proposes(
    fake: Any, own_ns: int, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    fake(ends_after=30)
    monkeypatch.setattr(stages, "step_of", lambda _: own_ns)
    assert texts(stages.sequence(FMU).findings) == [
        f"30 steps of {words} ms, terminated, freed",
        f"it ended the simulation by itself after t = {30 * own_ns / MS:g} ms",
    ]


class Log:
    """What is done with each instance, in its order."""

    def __init__(self, fake: Any, **given: Any) -> None:
        self.calls: list[tuple[str, Any]] = []

        def start(trial: FakeTrial) -> None:
            self.calls.append((trial.name, "start"))
            FakeTrial.start(trial)

        def run(trial: FakeTrial, lengths: Any) -> Any:
            self.calls.append((trial.name, len(list(lengths))))
            return FakeTrial.run(trial, lengths)

        fake(start=start, run=run, **given)


def test_every_trial_is_initialised_before_it_is_stepped(fake: Any) -> None:
    for stage in (stages.sequence, stages.steps, stages.determinism, stages.reset, stages.state,
                  stages.instances):  # fmt: skip
        log = Log(fake, can=SimpleNamespace(**{**CAN, "can_vary_step": False}))
        stage(FMU)
        started: set[str] = set()
        for name, what in log.calls:
            if what == "start":
                started.add(name)
            assert name in started, stage.__name__
        assert any(what != "start" for _, what in log.calls), stage.__name__
    log = Log(fake)
    stages.steps(FMU)
    assert [what for _, what in log.calls][::2] == ["start"] * 4


def test_the_second_instance_begins_when_the_first_one_is_half_way(fake: Any) -> None:
    """Then they are stepped in turns, the second first, and the second comes to its end alone."""
    log = Log(fake)
    stages.instances(FMU)
    assert log.calls == [
        ("trial", "start"), ("trial", 100), ("one", "start"), ("one", 50), ("two", "start"),
        *[("two", 1), ("one", 1)] * 50, ("two", 50),
    ]  # fmt: skip


@pytest.mark.parametrize("at", [1, 40, 70, 100])
def test_instances_that_disturb_each_other_alike_fail_too(fake: Any, at: int) -> None:
    """Each is compared with how it runs alone, not with the other one."""
    fake(odd=staticmethod(lambda one, count: 0.5 * (one.name != "trial" and count == at)))
    (found,) = stages.instances(FMU).findings
    assert (found.level, found.remedy) == ("FAIL", "use it once in a rig")
    assert f"x at t = {at} ms is {at}.0 and {at}.5" in found.text


@pytest.mark.parametrize("inner_us", [0, 50, 250])
def test_outputs_that_stand_still_longer_than_the_named_step_fail(
    inner_us: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A description that names 0.05 ms and a model that steps 1 ms: it is the model that counts."""
    ((level, text),) = course_of(held(MS), patch=monkeypatch, inner_ns=inner_us * US)
    assert (level, text) == ("FAIL", "its outputs stand still for steps below 1 ms")


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_course_that_cannot_be_loaded_is_none(
    count: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first instances cannot be made; with one course left there is nothing to compare."""
    made: list[int] = []

    class Trial:
        outputs: Any = ()

        def __init__(self, _: Path, *, moves: bool, drifts: bool = False) -> None:
            made.append(len(made))
            if len(made) <= count:
                raise UserError("no licence")

        def start(self) -> None: ...

        def close(self) -> None: ...

        def step(self, _step_ns: int) -> Any:
            return SimpleNamespace(values=())

        def course(self, step_ns: int, span_ns: int) -> list[Any]:
            return [self.step(step_ns)] * (span_ns // step_ns)

    monkeypatch.setattr(courses, "Trial", Trial)
    found = texts(courses.course_findings(FMU, 0))
    assert found == (["courses in steps of 1, 0.25 and 0.05 ms agree"] if count == 1 else [])
    assert len(made) == (4 if count == 1 else 3)


def test_a_course_of_many_changes_goes_through_all_of_them(monkeypatch: pytest.MonkeyPatch) -> None:
    slave = Slave()
    monkeypatch.setattr(release, "Exchange", Exchange)
    monkeypatch.setattr(release, "load_fmu", lambda _path, _name: slave)
    course = [Change(0.001 * number, "u", 10.0 + number) for number in range(20)]
    _, rows = release.walk(FMU, course, MS, 20)
    assert [value for *_, value in slave.given] == [change.value for change in course]
    assert [row[2] for row in rows] == [10.0, *(10.0 + number for number in range(20))]


@pytest.mark.parametrize(
    ("kind", "type_"), [("Float64", float), ("Real", float), ("Int32", int), ("Boolean", int)]
)
def test_an_input_gets_a_number_of_its_type(
    kind: str, type_: type, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The library takes no 1.0 for a whole number."""

    class Own(Slave):
        VARIABLES = (*Slave.VARIABLES[:-1], variable("u", type=kind, start="0"))

    slave = Own()
    monkeypatch.setattr(release, "Exchange", Exchange)
    monkeypatch.setattr(release, "load_fmu", lambda _path, _name: slave)
    release.walk(FMU, [Change(0.0, "u", 1.0), Change(0.001, "u", 0.0)], MS, 2)
    assert [(value, type(value)) for *_, value in slave.given] == [(1, type_), (0, type_)]


@pytest.mark.parametrize(
    ("model", "name"),
    [("AxisRig.Drives.ServoAxis", "ServoAxis"), ("Lib.A", "A"), ("A.B.C.D", "D"), ("Ramp", "Ramp")],
)
def test_files_of_a_release_have_the_last_part_of_the_name(
    model: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []
    given = [Change(0.0, "u", 1.0)]
    description = SimpleNamespace(defaultExperiment=None, modelVariables=[])
    monkeypatch.setattr(release, "load_description", lambda _path: (description, ""))
    monkeypatch.setattr(
        release, "courses",
        lambda: SimpleNamespace(get=lambda key, _none: asked.append(key) or given),
    )  # fmt: skip
    monkeypatch.setattr(release, "_input_rows", lambda *_: [])
    monkeypatch.setattr(release, "walk", lambda *_: (["time"], [[0.0]]))
    (tmp_path / "built.fmu").write_bytes(b"")
    path = release.release(tmp_path, model, "3.0", ["x"], tmp_path / "built.fmu", runs_here=True)
    assert (path.name, path.parent.name) == (f"{name}.fmu", name)
    assert {each.name for each in path.parent.iterdir()} == {
        f"{name}{ending}" for ending in (".fmu", "_ref.csv", "_in.csv", "_ref.opt")
    }
    assert asked == [model]  # its course goes by the full name
