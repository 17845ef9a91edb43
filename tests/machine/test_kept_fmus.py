"""An FMU that is reset in place of being loaded anew leaves nothing of the run before."""

import shutil
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.preparing import settings_of
from axisrig.bench.campaign.results.writer import CaseResult, RunFiles
from axisrig.bench.campaign.runner import run_case
from axisrig.bench.machine import kept_fmus
from axisrig.bench.machine.kept_fmus import close_fmus, take_fmu
from axisrig.bench.machine.machine import Machine
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.fmus import ensure_built
from axisrig.kernel.cosim.fmi.fmu import FmuSlave, PlantError
from axisrig.kernel.cosim.fmi.steps import StepsInARow
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program
from axisrig.kernel.time.clock import MS

TESTPLANS = Path(__file__).parents[2] / "testplans"
AXIS = "AxisRig.Drives.ServoAxis"


@pytest.fixture(autouse=True)
def _nothing_kept() -> None:
    kept_fmus.forget()


def case_of(plan: str, row: str, *inputs: str) -> Case:
    changed = read_plan(TESTPLANS / plan).with_inputs([parse_assignment(text) for text in inputs])
    return next(case for case in changed.cases if case.case == row)


def left(case: Case, folder: Path) -> tuple[object, ...]:
    """Run it; return its hash of frames, its facts, its checks, and the bytes of its files."""
    files = RunFiles([folder / "run.blf"], folder / "run.parquet")
    run = run_case(case, files)
    assert run.error is None
    values = [(item.check.metric, item.value, item.verdict) for item in run.checks]
    contents = [path.read_bytes() for path in (*files.bus_logs, folder / "run.parquet")]
    return run.frame_log_sha256, run.facts, values, contents


ROWS = [
    ("latch_accuracy.csv", "latch-pdo-lost"),  # axis and probe; it ends by an alarm
    ("distance_control.csv", "sign-both-plain"),  # axis and distance sensor
    ("distance_control.csv", "default-runs-away-1"),  # an alarm while the axis moves
]
LONG = [
    ("latch_accuracy.csv", "f2000"),
    ("fixed_stop_gantry.csv", "in-line-stiff"),  # four axes, stops
    ("fixed_stop_rotary.csv", None),
    ("measuring_edges.csv", "path-2ms"),
    ("reset.csv", None),
    ("motion.csv", None),
]


def first(plan: str, row: str | None) -> Case:
    return read_plan(TESTPLANS / plan).cases[0] if row is None else case_of(plan, row)


@pytest.mark.parametrize(
    ("plan", "row"), [*ROWS, *(pytest.param(*row, marks=pytest.mark.long) for row in LONG)]
)
@pytest.mark.long(but=1)
def test_a_run_on_fmus_that_were_reset_is_equal_to_one_on_new_ones(
    plan: str, row: str | None, tmp_path: Path
) -> None:
    case = first(plan, row)
    fresh = left(case, tmp_path)
    held = {key: kept.slave for key, kept in kept_fmus._kept.items()}
    assert held
    for _ in range(2):
        assert left(case, tmp_path) == fresh
    assert {key: kept.slave for key, kept in kept_fmus._kept.items()} == held


@pytest.mark.long
def test_other_start_values_of_the_run_before_are_forgotten(tmp_path: Path) -> None:
    fresh = left(case_of("latch_accuracy.csv", "latch-pdo-lost"), tmp_path)
    other = case_of("latch_accuracy.csv", "latch-pdo-lost", "plant:z.kv=25")
    assert left(other, tmp_path) != fresh
    assert left(case_of("latch_accuracy.csv", "latch-pdo-lost"), tmp_path) == fresh


@pytest.mark.long
def test_a_run_that_was_broken_off_leaves_nothing(tmp_path: Path) -> None:
    case = case_of("latch_accuracy.csv", "latch-pdo-lost")
    fresh = left(case, tmp_path)
    short = case_of("latch_accuracy.csv", "latch-pdo-lost", "plc:limit_s=0.01")
    assert "did not end" in (run_case(short, RunFiles()).error or "")
    assert left(case, tmp_path) == fresh


def broken(case: Case, monkeypatch: pytest.MonkeyPatch) -> CaseResult:
    """Run a case whose axis refuses a step at 20 ms."""
    take = StepsInARow.take

    def refuse(
        steps: StepsInARow, ends_ns: Sequence[int], given: Sequence[float] = ()
    ) -> list[list[float]]:
        if ends_ns[-1] > 20 * MS and steps._slave.name == "z":
            steps._slave.failed("doStep", 3)
        return take(steps, ends_ns, given)

    with monkeypatch.context() as patch:
        patch.setattr(StepsInARow, "take", refuse)
        return run_case(case, RunFiles())


@pytest.mark.interpreted
def test_an_fmu_that_has_failed_is_loaded_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = case_of("latch_accuracy.csv", "latch-pdo-lost")
    in_use = set(kept_fmus._kept)  # by a machine that another test has not closed
    fresh = left(case, tmp_path)
    before = {name: kept.slave for (_, name), kept in kept_fmus._kept.items()}
    assert "doStep: error" in (broken(case, monkeypatch).error or "")
    assert [name for _, name in kept_fmus._kept.keys() - in_use] == ["probe"]
    assert not before["z"].pointer
    assert left(case, tmp_path) == fresh
    assert kept_fmus._kept[before["z"].path, "z"].slave is not before["z"]


def used(slave: FmuSlave) -> FmuSlave:
    """Step an instance, and give it back."""
    slave.initialize(0)
    slave.step_to(MS)
    close_fmus([slave])
    return slave


def test_a_variable_that_is_none_is_refused_with_file_and_instance() -> None:
    path = ensure_built(AXIS)
    axis = take_fmu(path, "z")
    with pytest.raises(UserError) as refused:
        axis.variable("positon")
    assert f"FMU {path.name} (instance z) has no such variable" in str(refused.value)
    assert "position" in str(refused.value)
    used(axis)


def test_an_instance_is_handed_out_once_and_as_new() -> None:
    path = ensure_built(AXIS)
    axis = used(take_fmu(path, "z"))
    with pytest.raises(PlantError, match="the instance is freed"):
        axis.get("position")
    again, other = take_fmu(path, "z"), take_fmu(path, "z")
    assert again is axis is not other
    assert again.time_ns == 0
    assert not again.messages
    again.initialize(0)
    assert again.get("position") == pytest.approx(0.0)
    close_fmus([again, other])
    assert not other.pointer


@pytest.mark.parametrize("status", ["fails", "is missing"])
def test_an_fmu_whose_reset_does_not_work_is_loaded_anew(
    status: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = ensure_built(AXIS)
    axis = used(take_fmu(path, "z"))
    function = FmuSlave.function

    def spoilt(slave: FmuSlave, name: str, signature: tuple[Any, ...]) -> Callable[..., int]:
        if name != "fmi3Reset":
            found: Callable[..., int] = function(slave, name, signature)
            return found
        return (lambda _: 3) if status == "fails" else function(slave, "fmi3NoSuch", signature)

    monkeypatch.setattr(FmuSlave, "function", spoilt)
    new = take_fmu(path, "z")
    assert new is not axis
    assert new.pointer
    assert not axis.pointer
    close_fmus([new])


def test_a_file_that_has_changed_is_loaded_anew(tmp_path: Path) -> None:
    path = tmp_path / "axis.fmu"
    path.write_bytes(ensure_built(AXIS).read_bytes())
    axis = used(take_fmu(path, "z"))
    path.unlink()
    path.write_bytes(ensure_built(AXIS).read_bytes())
    new = take_fmu(path, "z")
    assert new is not axis
    close_fmus([new])


def test_only_so_many_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_fmus, "KEPT_MAX", 2)
    # Machines of tests before may not be closed yet: theirs are in use
    monkeypatch.setattr(kept_fmus, "_kept", OrderedDict())
    path = ensure_built(AXIS)
    axes = [used(take_fmu(path, name)) for name in ("x", "y", "z")]
    assert [name for _, name in kept_fmus._kept] == ["y", "z"]
    assert take_fmu(path, "z") is axes[2]


def test_an_fmu_of_the_user_is_loaded_anew(tmp_path: Path) -> None:
    """Who knows what its reset forgets."""
    shutil.copytree(TESTPLANS / "rigs", tmp_path / "rigs")
    own = tmp_path / "rigs" / "own.fmu"
    own.write_bytes(ensure_built(AXIS).read_bytes())
    rig = tmp_path / "rigs" / "probe-z.toml"
    text = rig.read_text("utf-8")
    assert f'fmu = "{AXIS}"' in text
    rig.write_text(text.replace(f'fmu = "{AXIS}"', 'fmu = "own.fmu"'), encoding="utf-8")
    case = replace(case_of("latch_accuracy.csv", "latch-pdo-lost"), rig=rig)
    settings = settings_of(case)
    program = read_program(case.program, tuple(settings.rig.axis))
    slaves = []
    for _ in range(2):
        machine = Machine(settings, program)
        slaves.append(machine.plant.axes["z"].slave)
        machine.close()
    assert slaves[0] is not slaves[1]
    assert not any(path == own for path, _ in kept_fmus._kept)


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("most", "dropped"), [(5, ""), (4, "a"), (3, "ac"), (2, "acd"), (1, "acde"), (0, "acde")]
)
def test_the_oldest_ones_that_nobody_uses_are_let_go(
    monkeypatch: pytest.MonkeyPatch, most: int, dropped: str
) -> None:
    """Of five b is in use: it counts, and it stays."""
    closed: list[str] = []
    kept: OrderedDict[Any, Any] = OrderedDict()
    for name in "abcde":
        slave = SimpleNamespace(pointer=7, close=lambda name=name: closed.append(name))
        entry = kept_fmus._Kept(slave, None, False, 0 if name == "b" else 9)  # type: ignore[arg-type]
        kept[Path("own.fmu"), name] = entry
    monkeypatch.setattr(kept_fmus, "_kept", kept)
    monkeypatch.setattr(kept_fmus, "KEPT_MAX", most)
    close_fmus([])
    assert "".join(closed) == dropped
    assert "".join(name for _, name in kept) == "".join(n for n in "abcde" if n not in dropped)
