"""Of runs with one seeded cause the budget names the right one: every cause, every source."""

import random
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from math import cos, log, pi, sqrt
from pathlib import Path

import pytest
from tests.tools.near import BETWEEN_SYNCS, NEAR

from axisrig.bench.campaign.results.writer import RunFiles
from axisrig.bench.campaign.runner import run_cases
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.tools.budget.budget import Budget, make_budget
from axisrig.bench.tools.budget.causes import causes

PLANS = Path(__file__).parents[2] / "testplans"
RIGS, PROGRAMS = PLANS / "rigs", PLANS / "programs"
RIGHT = 0.95

Draw = random.Random
Set = Callable[[Draw], dict[str, str]]


def even(column: str, low: float, high: float) -> Set:
    """A number between two."""
    return lambda draw: {column: f"{draw.uniform(low, high):.3f}"}


def whole(column: str, low: int, high: int) -> Set:
    """A whole number between two."""
    return lambda draw: {column: str(draw.randint(low, high))}


def fixed(column: str, value: str) -> Set:
    return lambda _draw: {column: value}


MODULUS = 2**31 - 1


def scattered(seed: int) -> float:
    """The first number of the pre-travel: by Box and Muller, from two sequences of the seed."""
    radius = 48271 * (1 + 1226874159 * seed % (MODULUS - 1)) % MODULUS
    angle = 69621 * (1 + 62089911 * seed % (MODULUS - 1)) % MODULUS
    return sqrt(-2 * log(radius / MODULUS)) * cos(2 * pi * angle / MODULUS)


def radioed(seed: int) -> float:
    """The first deviation of the radio, -1 to 1."""
    return 2 * (16807 * (1 + 742938285 * seed % (MODULUS - 1)) % MODULUS / MODULUS) - 1


def later_seed(draw: Draw, number: Callable[[int], float]) -> str:
    """A seed whose first touch is later than usual: earlier than the contact is no touch."""
    return str(next(s for s in iter(lambda: draw.randint(1, 9999), 0) if number(s) > 0.2))


@dataclass(frozen=True)
class Bench:
    """A rig with a source, all of whose causes are off. only: those that are looked at there."""

    rig: str
    source: str
    quiet: dict[str, str] = field(default_factory=dict)


NO_DELAY = {"drive:servo.input_delay_us": "0"}
QUICK_PLC = {"plc:period_us": "50"}
STILL = {
    f"plant:probe.{name}": "0"
    for name in (
        *("pretravel_um", "pretravel_scatter_um", "first_touch_um", "drift_um"),
        *("bounce_count", "radio_delay_ms", "radio_jitter_us"),
    )
} | {"plant:z.backlash_um": "0"}
SMOOTH = {f"plant:z.friction.{name}": "0" for name in ("coulomb_n", "breakaway_n", "viscous_n_s_m")}
DRIVE = Bench("probe-z", "DRIVE", NO_DELAY)
TYPE_DEFAULT = Bench("probe-z", "DRIVE_TYPE_DEFAULT", NO_DELAY)
HABITS = Bench("probe-z-workpiece", "DRIVE", NO_DELAY)
WALL = Bench("probe-z-wall", "DRIVE", NO_DELAY)
REAL = Bench("probe-z-real", "DRIVE", NO_DELAY | STILL)
RADIO = Bench("plc-radio", "EXT_PROBE_WITH_DRIVE", NO_DELAY | {"plc:period_us": "1000"})
PLC = Bench("plc-signal", "PLC", QUICK_PLC)
FIRST = Bench("plc-signal", "PLC_FIRST_EVENT", QUICK_PLC)
STAMP = Bench("plc-timestamp", "PLC_TIMESTAMP", QUICK_PLC)
STAMP_ETHERCAT = Bench("plc-timestamp-ethercat", "PLC_TIMESTAMP", QUICK_PLC)
STAMP_LINE = Bench("plc-timestamp-line", "PLC_TIMESTAMP", QUICK_PLC)
EXTERNAL = Bench("plc-external", "PLC_EXT_LATCH_CONTROL", QUICK_PLC)
INPUT = Bench("plc-drive-input", "PLC", QUICK_PLC | NO_DELAY | BETWEEN_SYNCS)
AT_PLC = (PLC, FIRST, EXTERNAL)
BY_DRIVE = (DRIVE, TYPE_DEFAULT, RADIO)
EVERY = (*BY_DRIVE, *AT_PLC, STAMP)
SOURCES = (DRIVE, PLC, STAMP)
"""Of what is not of the signal."""
ELASTIC = {"plant:probe.seat_force_n": "4", "plant:probe.bending_stiffness_n_m": "1e12"}

SEEDED: dict[str, tuple[tuple[Bench, ...], Set]] = {
    "lobing": ((WALL,), even("plant:probe.seat_force_n", 2, 12)),
    "contact": (
        (WALL,),
        lambda draw: ELASTIC | {"plant:probe.contact_modulus": f"{draw.uniform(0.1, 2):.3f}e9"},
    ),
    "pre-travel": (EVERY, even("plant:probe.pretravel_um", 11, 20)),
    "scatter": (
        (HABITS,),
        lambda draw: (
            even("plant:probe.pretravel_scatter_um", 8, 20)(draw)
            | {"plant:probe.seed": later_seed(draw, scattered)}
        ),
    ),
    "first touch": ((HABITS,), even("plant:probe.first_touch_um", 1, 20)),
    "drift": ((HABITS,), even("plant:probe.drift_um", 0.5, 5)),
    "trigger": ((*BY_DRIVE, STAMP), even("plant:probe.trigger_delay_us", 20, 400)),
    "radio": ((HABITS, RADIO), even("plant:probe.radio_delay_ms", 0.1, 12)),
    "radio jitter": (
        (HABITS, RADIO),
        lambda draw: (
            even("plant:probe.radio_jitter_us", 400, 900)(draw)
            | {"plant:probe.seed": later_seed(draw, radioed)}
        ),
    ),
    "input": (BY_DRIVE, even("drive:servo.input_delay_us", 20, 400)),
    "input jitter": (BY_DRIVE, even("drive:servo.input_jitter_us", 200, 900)),
    "filter": (BY_DRIVE, even("drive:servo.input_filter_us", 20, 400)),
    "compensation": (BY_DRIVE, even("drive:servo.delay_compensation_us", 20, 400)),
    "sampling": (
        BY_DRIVE,
        lambda draw: (
            {"drive:servo.latch": "sampled"} | whole("drive:servo.sample_us", 250, 1000)(draw)
        ),
    ),
    "terminal filter": ((*AT_PLC, STAMP), even("plc:terminal.filter_us", 2000, 9000)),
    "stamp resolution": ((STAMP,), whole("plc:terminal.stamp_resolution_ns", 20_000, 400_000)),
    "stamp jitter": ((STAMP,), whole("plc:terminal.stamp_jitter_ns", 20_000, 400_000)),
    "clock offset": ((STAMP,), whole("plc:clock_offset_ns", -900_000, -20_000)),
    "clock drift": ((STAMP,), even("plc:clock_drift_ppm", -900, -200)),
    "assumed sampling": (
        (STAMP_ETHERCAT, STAMP_LINE),
        whole("bus:ec1.assumed_sample_us", -400, -20),
    ),
    "line delay": (
        (STAMP_LINE,),
        lambda draw: (
            {"bus:ec1.wire_ns": f"terminal={draw.randint(9_000, 90_000)}"}
            | fixed("bus:ec1.delay_compensation", "false")(draw)
        ),
    ),
    "line drift": (
        (STAMP_LINE,),
        lambda draw: (
            {"bus:ec1.drift_ppm": f"terminal={draw.randint(-900, -200)}"}
            | fixed("bus:ec1.drift_compensation", "false")(draw)
        ),
    ),
    "terminal cycle": (
        AT_PLC,
        lambda draw: (
            whole("plc:terminal.cycle_us", 9000, 20_000)(draw) | {"plc:terminal.offset_us": "0"}
        ),
    ),
    "PLC cycle": ((*AT_PLC, INPUT), whole("plc:period_us", 6000, 15_000)),
    "handed-over position": ((EXTERNAL,), fixed("plc:V.E.POSITION", "1")),
    "encoder noise": ((), even("plant:z.noise_um", 0.5, 3)),
    "PDO": ((DRIVE,), lambda draw: {"fault:alter": f"Z.TPDO2 byte=1 xor={draw.randint(16, 255)}"}),
    "screw friction": (
        (REAL,),
        lambda draw: {
            "plant:z.friction.coulomb_n": f"{draw.uniform(100, 400):.1f}",
            "plant:z.friction.breakaway_n": "400",
            "plant:z.friction.viscous_n_s_m": "0",
        },
    ),
    "viscous friction": (
        (REAL,),
        lambda draw: SMOOTH | {"plant:z.friction.viscous_n_s_m": f"{draw.uniform(2e3, 2e4):.0f}"},
    ),
    "backlash": ((REAL,), even("plant:z.backlash_um", 5, 40)),
    "dead time": (BY_DRIVE, whole("set:Z.kenngr.probe_actuation_time_delay", 20, 400)),
}
"""Where a cause can be the only one, and what it is set to."""
NOT_ALONE = {
    "bounce": "acts with a filter or a slow exchange only (tests/tools/test_budget_forms.py)",
    "stamp edge": "needs a signal that bounces",
    "friction": "of a stiff screw: changes the motion, not where a signal finds the axis",
    "encoder": "never more than its increment",
    "run-up": "is a part of what delays cost",
    "braking": "is a part of what delays cost",
}
"""Causes that have no share by themselves."""


def test_every_cause_is_drawn_or_says_why_not() -> None:
    assert set(SEEDED) | set(NOT_ALONE) == {cause.cause for cause in causes()}
    assert not set(SEEDED) & set(NOT_ALONE)


def seeded(name: str, bench: Bench, draw: Draw, folder: Path) -> Case:
    """One touch with one cause."""
    plan = read_plan(PLANS / "latch_accuracy.csv")
    case = only(plan.cases, "f600")
    rig = RIGS / f"{bench.rig}.toml"
    inputs = {"plc:V.E.FEED": "600"} | NEAR | bench.quiet
    inputs |= {"set:Z.kenngr.measure.signal": bench.source}
    program = PROGRAMS / "touch-once.nc"
    if name in ("drift", "encoder noise"):  # the noise of the start is in a relative target
        program = PROGRAMS / "touch-often.nc"
        touches = "2" if name == "drift" else "1"
        inputs |= {"plc:V.E.TOUCHES": touches, "plc:V.E.ABOVE": "100.3"}
    if name == "encoder noise":
        rig = stiff_rig(folder, bench.rig)
        inputs = {
            c: v for c, v in inputs.items() if c not in ("plant:z.kv", "plant:z.feed_forward")
        }
        inputs |= {"set:Z.getriebe[0].window": "1000"}
    if name == "PDO":
        inputs |= {"drive:servo.latch_check": "false"}
    inputs |= SEEDED[name][1](draw)
    return replace(case, rig=rig, program=program, inputs=inputs, seed=draw.randint(1, 10**6))


def stiff_rig(folder: Path, name: str) -> Path:
    """A rig whose load is where its demand is: the axis with an encoder that has noise."""
    text = (RIGS / f"{name}.toml").read_text(encoding="utf-8")
    text = text.replace('"lists/', f'"{RIGS}/lists/').replace('"../plc/', f'"{PLANS}/plc/')
    text = text.replace("AxisRig.Drives.ServoAxis", "AxisRig.Drives.KinematicAxis")
    lines = [
        "start = { position_start_mm = 130 }" if line.startswith("start = { position") else line
        for line in text.splitlines()
    ]
    base = next((line for line in lines if line.startswith("base =")), None)
    if base is not None:
        inner = stiff_rig(folder, base.split('"')[1].removesuffix(".toml"))
        lines[lines.index(base)] = f'base = "{inner}"'
    path = folder / f"{name}-stiff.toml"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def budget_of(case: Case) -> Budget:
    return make_budget(case, None, partial(run_cases, files_of=lambda _: RunFiles()))


@pytest.mark.long
def test_of_runs_with_one_cause_it_names_the_right_one_at_every_source(tmp_path: Path) -> None:
    """A share is named when it is above an increment; a drawn delay may be smaller than that."""
    draw = random.Random(20)
    runs = [(name, bench) for name, (at, _) in SEEDED.items() for bench in at or SOURCES]
    wrong, offs = [], []
    for name, bench in runs:
        case = seeded(name, bench, draw, tmp_path)
        budget = budget_of(case)
        share = budget.largest
        if share is None or share.cause.cause != name:
            wrong.append((name, bench.source, case.inputs, share and share.cause.cause))
        total = sum(each.in_turn_um for each in budget.shares) + budget.left_um
        assert total == pytest.approx(budget.error_um, abs=1e-9)
        if not budget.is_explained or budget.differing:
            offs.append((name, bench.source, case.inputs, budget.left_um, budget.differing))
        assert abs(budget.left_um) <= budget.increment_um, (name, case.inputs)
    assert not offs
    assert len(wrong) <= (1 - RIGHT) * len(runs), wrong
