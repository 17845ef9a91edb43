"""A budget where what is alike elsewhere differs: two axes, two probes, signs."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from tests.recordings import facts, kept

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import judge, parse_check
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.axes import AxisRecord, Contact, Edge, ProbeRecord
from axisrig.bench.record.measuring import MeasurementRun
from axisrig.bench.record.signal_sources import STAMPED
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.budget.budget import Budget, Share, make_budget
from axisrig.bench.tools.budget.causes import Active, active_causes, causes, measuring_axis
from axisrig.bench.tools.budget.closed_forms import expected_um
from axisrig.bench.tools.budget.combining import Runs, combined, groups
from axisrig.bench.tools.budget.motion import without_run_up
from axisrig.bench.tools.budget.observed_run import METRICS, Seen, Track, see
from axisrig.bench.tools.budget.words import LEFT, budget_lines
from axisrig.kernel.time.clock import MS

PLANS = Path(__file__).parents[2] / "testplans"
RIGS = PLANS / "rigs"
CAUSES = {each.cause: each for each in causes()}
BOTH_WAYS = pytest.mark.parametrize("sign", [1, -1])


def share(cause: str = "trigger", um: float = -1.5, **more: Any) -> Share:
    values = {"cause": CAUSES[cause], "setting": f"set {cause}", "alone_um": um,
              "in_turn_um": um, "expected_um": None, "bound_um": None}  # fmt: skip
    return Share(**(values | more))


def budget(*shares: Share, left_um: float = 0.0, increment_um: float = 0.1) -> Budget:
    return Budget("plan.row", "Z", -9.5, -10.0, increment_um, left_um, shares)


# Closed forms within an increment


@BOTH_WAYS
@pytest.mark.parametrize(
    ("off_um", "expected_um", "differs"),
    [(0.09, 1.0, False), (0.11, 1.0, True), (0.19, 20.0, False), (0.21, 20.0, True),
     (0.09, 0.0, False), (0.11, 0.0, True)],
)  # fmt: skip
def test_a_share_differs_by_more_than_an_increment_and_more_than_a_hundredth(
    sign: int, off_um: float, expected_um: float, differs: bool
) -> None:
    """Of what is expected, whatever its direction and whichever of both is less."""
    for side in (1, -1):
        um = sign * expected_um + side * off_um
        each = share(um=um, expected_um=sign * expected_um)
        made = budget(share("radio", 5.0), each)
        assert made.differing == ((each,) if differs else ())
        (line,) = (line for line in budget_lines(made) if line.startswith("trigger "))
        assert (f"  differs by {side * off_um:+.4f}" in line) is differs


@BOTH_WAYS
def test_a_share_within_its_bound_does_not_differ_up_to_an_increment_beyond(sign: int) -> None:
    for beyond_um, differs in ((-0.3, False), (0.09, False), (0.11, True)):
        each = share("encoder", sign * (0.4 + beyond_um), bound_um=0.4)
        assert budget(each).differing == ((each,) if differs else ())
        if differs:
            assert each.differs_um(0.1) == pytest.approx(beyond_um)


# Words


@pytest.mark.parametrize(
    ("left_um", "shown"),
    [(-0.0625, "-0.0625"), (0.0625, "+0.0625"), (0.0, "+0.0000"), (-1e-9, "+0.0000")],
)
def test_what_is_left_has_its_sign(left_um: float, shown: str) -> None:
    (line,) = (each for each in budget_lines(budget(left_um=left_um)) if each.startswith(LEFT))
    assert line.split() == [*LEFT.split(), shown]


@pytest.mark.parametrize(
    ("given", "shown"),
    [({"expected_um": 0.0}, "+0.0000"), ({"expected_um": -1.5}, "-1.5000"),
     ({"expected_um": 1.25}, "+1.2500"), ({}, ""), ({"bound_um": 0.0}, "+- 0.0000"),
     ({"bound_um": 2.0}, "+- 2.0000"), ({"bound_um": 2.0, "expected_um": -1.5}, "+- 2.0000")],
)  # fmt: skip
def test_a_closed_form_of_nothing_is_one(given: Mapping[str, float], shown: str) -> None:
    """A share that is expected to be 0 is shown as 0, one without a closed form as nothing."""
    (line,) = (
        each
        for each in budget_lines(budget(share(**given), increment_um=9.0))
        if each.startswith("trigger ")
    )
    assert (
        line == f"{'trigger':<20} {'set trigger':<44} {'-1.5000':>10} {'-1.5000':>11} {shown:>15}"
    )


def test_causes_that_differ_are_named_apart_from_those_that_act_on_each_other() -> None:
    """Four causes: one is both, one each, and one none."""
    shares = (
        share("trigger", 1.0, expected_um=3.0),
        share("radio", 1.0, interacts=True, combined_um=2.0),
        share("bounce", 1.0, expected_um=-3.0, interacts=True, combined_um=2.0),
        share("input", 1.0, expected_um=1.0),
    )
    differs, acts = budget_lines(budget(*shares))[-2:]
    assert differs.startswith("differs from its closed form")
    assert differs.endswith(": trigger, bounce")
    assert acts.startswith("these act on each other")
    assert acts.endswith(": radio, bounce")


# Which causes are on


def two_probes(**given: Any) -> Any:
    """X has a probe at its drive or not; a probe is at the terminal; Y and Z may measure."""
    at_drive = given.get("at_drive", {"X"})
    axes = {
        name: SimpleNamespace(probe_1="own" if name in at_drive else None) for name in ("X", "Y")
    }
    terminal = SimpleNamespace(inputs={1: "other"})
    measures: Callable[[str], Any] = lambda name: SimpleNamespace(  # noqa: E731
        flag=lambda _key: name in given.get("measuring", {"X", "Y"})
    )
    return SimpleNamespace(
        rig=SimpleNamespace(axis=axes, plc_task=SimpleNamespace(terminal=terminal)),
        axis={name: measures(name) for name in axes},
        files=[Path("rig.toml")],
    )


def test_a_probe_at_a_drive_measures_before_one_at_a_terminal() -> None:
    """The axis whose drive has it, though others are measuring axes by their lists."""
    for name in ("X", "Y"):
        assert measuring_axis(two_probes(at_drive={name}), None) == name
    assert measuring_axis(two_probes(at_drive=set(), measuring={"Y"}), None) == "Y"
    assert measuring_axis(two_probes(at_drive=set()), "Y") == "Y"
    assert measuring_axis(two_probes(at_drive={"X"}, measuring=set()), None) == "X"


def on(settings: Any, axis: str = "Z", *, latched: bool = True, **more: Any) -> dict[str, Active]:
    case: Any = SimpleNamespace(inputs={})
    return {each.cause.cause: each for each in active_causes(case, settings, axis, latched, **more)}


@pytest.mark.parametrize("program", ["own/latch.py", "external_latch.txt", None])
def test_what_another_program_hands_over_is_not_known(program: str | None) -> None:
    """V.E.POSITION is a variable of the shipped program; another one may use it as it likes."""
    settings = settings_of(RIGS / "plc-external.toml", ["plc:V.E.POSITION=1"])
    task = settings.rig.plc_task
    assert task is not None
    assert "handed-over position" in on(settings, latched=False, is_external=True)
    other = None if program is None else Path(program)
    rig = settings.rig.model_copy(update={"plc_task": task.model_copy(update={"program": other})})
    settings.rig = rig
    assert "handed-over position" not in on(settings, latched=False, is_external=True)


@pytest.mark.parametrize(
    ("fmu", "names"),
    [
        ("own/ServoAxis.fmu", {"friction"}),
        ("own/MyServoAxis.fmu", {"friction"}),
        ("own/ServoAxisOfMine.fmu", set()),
        ("ServoAxis/Plain.fmu", set()),
        ("own/ScrewAxis2.fmu", set()),
        ("ScrewAxis", {"screw friction", "viscous friction"}),
    ],
)
def test_a_model_is_what_its_name_ends_with(fmu: str, names: set[str]) -> None:
    """The start values of another one may be others, though its name or folder begins so."""
    settings = settings_of(RIGS / "probe-z.toml", [])
    bare = settings.rig.plant["z"].model_copy(update={"fmu": fmu, "start": {}})
    settings.rig.plant["z"] = bare
    assert set(on(settings)) - {"input", "encoder"} == names


def test_a_cause_of_a_line_is_that_of_any_axis_on_it() -> None:
    """An axis that is named first, and is on no line, has none; the other one has its own."""
    settings = settings_of(
        RIGS / "plc-timestamp-line.toml",
        ["bus:ec1.drift_compensation=false", "bus:ec1.assumed_sample_us=Z=70"],
    )
    table = settings.rig.axis["Z"]
    elsewhere = table.model_copy(update={"segment": "can1"})
    settings.rig = settings.rig.model_copy(update={"axis": {"A": elsewhere, "Z": table}})
    found = on(settings, latched=False)
    assert {"line drift", "assumed sampling"} <= set(found)
    assert found["assumed sampling"].value == "70"


def test_the_stop_of_a_run_up_is_that_of_each_axis() -> None:
    """What brakes after a signal stays as it is, of each axis what its own list says."""
    given = {"X": (800, 1100), "Y": (900, 1200), "Z": (700, 1300)}
    settings = settings_of(
        RIGS / "probe-xyz.toml",
        [
            text
            for axis, (stop, brake) in given.items()
            for text in (
                f"set:{axis}.getriebe[0].lslope_profil.a_feedh={stop}",
                f"set:{axis}.getriebe[0].lslope_profil.d_grenz_stufe_1={brake}",
            )
        ],
    )
    columns = without_run_up(settings)
    for axis, (stop, brake) in given.items():
        linear = f"set:{axis}.getriebe[0].lslope_profil"
        assert columns[f"{linear}.a_feedh"] == str(stop)
        assert columns[f"{linear}.d_grenz_stufe_1"] == str(brake)
    assert set(settings.rig.axis) == set(given)


# Runs that differ


def running(
    values: Callable[[Mapping[str, str]], tuple[float, float, float | None, float | None]],
) -> Callable[[Sequence[Case]], Iterator[CaseResult]]:
    def run(cases: Sequence[Case]) -> Iterator[CaseResult]:
        for case in cases:
            there = dict(zip(METRICS, values(case.inputs), strict=True))
            checks = [judge(check, there[check.name]) for check in case.checks]
            facts: Any = SimpleNamespace(frame_log_sha256=case.run)
            yield CaseResult(case, Verdict.PASS, checks, facts=facts)

    return run


@BOTH_WAYS
def test_a_bound_is_of_the_speed_of_the_run_with_all_causes(sign: int) -> None:
    """5000 ns at 10 mm/s are 0.05 um; without the jitter the axis would have 40 mm/s."""

    def values(inputs: Mapping[str, str]) -> tuple[float, float, float | None, float | None]:
        off = inputs.get("plc:terminal.stamp_jitter_ns") == "0"
        return 0.0, sign * (40.0 if off else 10.0), None, 0.0

    row = next(
        each for each in read_plan(PLANS / "plc_sources.csv").cases
        if each.rig.name == "plc-timestamp.toml"
    )  # fmt: skip
    row = replace(row, inputs={**row.inputs, "plc:terminal.stamp_jitter_ns": "5000"})
    found = {each.cause.cause: each for each in make_budget(row, "Z", running(values)).shares}
    assert found["stamp jitter"].bound_um == pytest.approx(0.05)


class Game:
    """Runs of so many causes whose error is a function of those that are on."""

    def __init__(self, count: int, error_um: Callable[[set[int]], float]) -> None:
        self._error_um, self._all = error_um, set(range(count))
        self.runs = Runs(count, self._make, self._of)

    def _make(self, offs: Iterable[frozenset[int]]) -> None:
        pass

    def _of(self, off: Iterable[int]) -> float:
        return self._error_um(self._all - set(off))


@pytest.mark.parametrize("left_um", [50.0, -50.0, 0.0])
def test_what_is_left_with_all_causes_off_lets_none_act_on_another(left_um: float) -> None:
    game = Game(3, lambda on: left_um + 1.0 * (0 in on) + 2.0 * (1 in on) - 4.0 * (2 in on))
    assert groups(game.runs, 1e-6) == [[0], [1], [2]]
    found = combined(game.runs, 1e-6)
    assert found.shares_um == pytest.approx({0: 1.0, 1: 2.0, 2: -4.0})
    assert (found.interacting, found.left_out) == (frozenset(), frozenset())
    both = Game(3, lambda on: left_um + 6.0 * ({1, 2} <= on) + 1.0 * (0 in on))
    assert groups(both.runs, 1e-6) == [[0], [1, 2]]


def ramp(begin_mm: float, speed_mm_s: float, edge_ms: float) -> Track:
    times = [k * MS for k in range(8)]
    places = [begin_mm + speed_mm_s * k * 1e-3 for k in range(8)]
    return Track(times, places, [speed_mm_s] * 8, 2 * MS, 1, edge_ms)


@BOTH_WAYS
def test_the_edge_of_each_run_is_at_the_speed_of_that_run(sign: int) -> None:
    """6 mm/s for 0.9 ms with the scatter, 20 mm/s for 0.2 ms without: 5.4 less 4 um."""
    scatter = Active(CAUSES["scatter"], "1", "", {})
    settings = settings_of(RIGS / "probe-z.toml", [])
    for source, latch_ms in (("", 1.5), (STAMPED, None)):
        later, without = (
            Seen(-1.0, sign * speed, latch_ms, None, ramp(50, sign * speed, edge_ms), source=source)
            for speed, edge_ms in ((6.0, 0.9), (20.0, 0.2))
        )
        found = expected_um(scatter, settings, "Z", later, without)
        assert found == pytest.approx(sign * 1.4)


# Plants with names of their own


@pytest.mark.parametrize(("axis", "per_length"), [("X", 2.0), ("Z", -1.0)])
def test_speeds_of_a_touch_are_those_of_the_axes_that_move_the_plants_of_the_probe(
    axis: str, per_length: float
) -> None:
    """X goes 20 and Z -10 mm/s onto a plane: X has twice the way; neither plant is called so."""
    ms = np.arange(40, dtype=np.float64)
    table = pa.table({
        "time_ns": np.arange(40, dtype=np.int64) * MS,
        "X.truth_mm": 0.02 * ms, "X.velocity_mm_s": np.full(40, 20.0),
        "Z.truth_mm": 5 - 0.01 * ms, "Z.velocity_mm_s": np.full(40, -10.0),
    })  # fmt: skip
    plants = {"X": "table", "Z": "quill"}
    contact = Contact(20 * MS, {"table": 0.4, "quill": 4.8})
    left = facts(
        axes={name: AxisRecord("can1", n, 1.0, plant=plant, signals={"probe_1": "probe"})
              for n, (name, plant) in enumerate(plants.items(), 1)},
        probes={"probe": ProbeRecord(True, 1.0, contacts=(contact,), edges=(Edge(20 * MS, True),))},
        runs=(MeasurementRun(("X", "Z"), begin_ns=MS, end_ns=35 * MS, inputs={"X": 1, "Z": 1}),),
        end_ns=40 * MS, sim_ns=40 * MS,
    )  # fmt: skip
    rig = SimpleNamespace(
        axis={name: SimpleNamespace(drive="servo", plant=plant, probe_1="probe")
              for name, plant in plants.items()},
        plant={
            "table": SimpleNamespace(start={}, wire={}),
            "quill": SimpleNamespace(start={}, wire={}),
            "probe": SimpleNamespace(start={}, wire={"x": "table", "z": "quill"}),
        },
    )  # fmt: skip
    values = dict(zip(METRICS, (-1.0, -10.0, 0.3, None), strict=True))
    checks = [
        judge(parse_check(f"{name}:{axis}", "-1e9 .. 1e9", ""), value, 0.0, "none")
        for name, value in values.items()
    ]
    case: Any = SimpleNamespace(run="p-a", inputs={})
    settings: Any = SimpleNamespace(rig=rig, start={})
    result = CaseResult(case, Verdict.PASS, checks, facts=left, series=kept(table))
    assert see(result, axis, settings).per_length == pytest.approx(per_length)
