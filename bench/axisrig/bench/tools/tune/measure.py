"""Runs of a rig that show how its distance control answers: at rest, and to steps.

The offset is moved by SET_POS, whose loop holds only the skew of the two encoders and no drive,
with a small kp, no filter and limits out of reach: so it is calm before there is data on the
drive. What the offset causes is then a plain open path: from the offset that a cycle computes
to the sensor value that a later cycle reads.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from axisrig.bench.machine.machine import Machine, SimulatedTimeoutError
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.record.series import SECOND, TARGET, Telegrams
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.real_axes import is_paced
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.bench.tools.tune.loop import Floats, Law
from axisrig.kernel.channel import Channel
from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import parse_program

RELEASED = "lr_param.distance_control_on"
PREFIX = "kenngr.distc."
PROBING_KP = 0.15
# Out of reach, so that the loop stays linear; in the units of the list
WITHOUT_LIMITS: Mapping[str, object] = {
    "i_tn": 0,
    "d_tv": 0,
    "v_max": 2_000_000_000,
    "a_max": 2_000_000_000,
    "use_adaptive_acceleration": 0,
    "v_weight_down": 0,
    "a_weight_down": 0,
    "max_act_value_change": 2_000_000_000,
    "max_deviation": 2_000_000_000,
}
_WITHOUT_FILTER: Mapping[str, object] = {
    "filter_type": "MOVING_AVERAGE",
    "n_cycles": 1,
    "low_pass_filter_enable": 0,
}
REST_CYCLES = 200
_LIFT_MM_MIN = 60


@dataclass(frozen=True)
class Bench:
    """What is tuned: an axis of a rig.

    variable: V.E. variable that has the distance, None for the second encoder. changes: of
    `--set`.
    """

    rig: Path
    axis: str
    variable: str | None
    changes: tuple[str, ...]

    def settings(self, parameters: Mapping[str, object] | None = None) -> Settings:
        """Read the rig, with these parameters of distance control in place of its own.

        Its limits then clamp: a slope would act on each step that is larger than the error.
        """
        own = [f"set:{self.axis}.{PREFIX}{name}={v}" for name, v in (parameters or {}).items()]
        own += ["distance:limiter=clamp"] if parameters else []
        assigned = [(parse_assignment(text), as_written) for text in (*self.changes, *own)]
        return read_settings(*read_rig(self.rig), assigned)


@dataclass(frozen=True)
class Steps:
    """How many steps, cycles between two of them, and the period of a cycle."""

    count: int
    cycles: int
    period_s: float


@dataclass(frozen=True)
class Signals:
    """By cycles: set value of the control, offset computed in it, set position sent in it, actual
    position and distance read in it, all in mm.
    """

    wanted_mm: Floats
    offset_mm: Floats
    set_mm: Floats
    actual_mm: Floats
    distance_mm: Floats


@dataclass(frozen=True)
class Run:
    """Signals of one run, and the frames of its set positions and second encoder."""

    signals: Signals
    targets: Telegrams
    sensor: Telegrams


def choose(rig: Path, axis: str | None, variable: str | None, changes: Sequence[str]) -> Bench:
    """Find the axis: the one that is said, or the only one with distance control.

    Raises UserError when it cannot be found or its bus is a real one.
    """
    settings = Bench(rig, axis or "", variable, tuple(changes)).settings()
    released = [name for name, values in settings.axis.items() if values.flag(RELEASED)]
    if is_paced(settings):
        hint = "take a rig with the simulated bus; the loop outside can be recorded by axisrig run"
        raise UserError("the rig has a real CAN interface", file=rig, hint=hint)
    if axis is not None and axis not in settings.axis:
        raise UserError("the rig has no such axis", value=axis, allowed=list(settings.axis))
    if axis is not None and axis not in released:
        hint = f"set {RELEASED} (P-AXIS-00328) to 1 in its list, or by --set"
        raise UserError("distance control of the axis is not released", value=axis, hint=hint)
    if not released:
        hint = f"{RELEASED} (P-AXIS-00328) = 1 in the list of an axis releases it"
        raise UserError("no axis of the rig has distance control", file=rig, hint=hint)
    if axis is None and len(released) > 1:
        raise UserError("several axes have distance control", allowed=released, hint="say --axis")
    return Bench(rig, axis or released[0], variable, tuple(changes))


def at_rest(bench: Bench, step_mm: float, period_s: float) -> Signals:
    """Keep the axis at rest with the control off, lift it by step_mm, and keep it at rest again."""
    wait = f"G4 {REST_CYCLES * period_s:.6g}"
    lift = f"G1 {bench.axis}{step_mm:.6f} F{_LIFT_MM_MIN}"
    return _run(bench, {}, [wait, f"G91 {lift}", "G90", wait]).signals


def surface_steps(bench: Bench, surface_mm: float, step_mm: float, steps: Steps) -> Run:
    """Move SET_POS up and down by step_mm, with a small kp and without filter."""
    parameters = {**WITHOUT_LIMITS, **_WITHOUT_FILTER, "kp": PROBING_KP}
    places_mm = [surface_mm + step_mm * (1 - number % 2) for number in range(steps.count)]
    return _stepped(bench, parameters, f"ON SET_POS={surface_mm:.6f}", "SET_POS", places_mm, steps)


def distance_step(bench: Bench, law: Law, distance_mm: float, step_mm: float, steps: Steps) -> Run:
    """Move SET_DIST by step_mm with the filter of the list and without its limits."""
    own = {"kp": law.kp, "i_tn": law.tn_s, "d_tv": law.tv_s}
    start = f"ON CONST_DIST SET_DIST={distance_mm:.6f}"
    places_mm = [distance_mm + step_mm]
    return _stepped(bench, {**WITHOUT_LIMITS, **own}, start, "SET_DIST", places_mm, steps)


def _stepped(
    bench: Bench,
    parameters: Mapping[str, object],
    start: str,
    word: str,
    places_mm: Sequence[float],
    steps: Steps,
) -> Run:
    wait = f"G4 {steps.cycles * steps.period_s:.6g}"
    rest = f"G4 {REST_CYCLES * steps.period_s:.6g}"
    blocks = [rest, f"{bench.axis}[DIST_CTRL {start}]", rest]
    for place_mm in places_mm:
        blocks += [f"{bench.axis}[DIST_CTRL {word}={place_mm:.6f}]", wait]
    return _run(bench, parameters, [*blocks, f"{bench.axis}[DIST_CTRL OFF NO_MOVE]"])


def _run(bench: Bench, parameters: Mapping[str, object], blocks: Sequence[str]) -> Run:
    """Run a program of these blocks. Raises UserError when it does not come to its end."""
    if bench.variable is not None:
        source = f"SENSOR_SOURCE=VARIABLE SENSOR_VAR={bench.variable}"
        blocks = [f"{bench.axis}[DIST_CTRL {source}]", *blocks]
    numbered = enumerate([*blocks, "M30"], 1)
    text = "".join(f"N{10 * number} {block}\n" for number, block in numbered)
    settings = bench.settings(parameters)
    program = parse_program(text, file="program of axisrig tune", axes=tuple(settings.rig.axis))
    machine = Machine(settings, program)
    log = _Log(bench.axis, "SET_DIST" in text)
    machine.channel.observers.append(log)
    try:
        machine.run()
        series = machine.recorder.series()
    except (PlantError, SimulatedTimeoutError) as error:
        raise UserError(str(error), file=bench.rig) from error
    finally:
        machine.close()
    ended = [alarm for alarm in machine.channel.alarms if alarm.ends_program]
    if ended:
        hint = "the axis has to start where the sensor sees the surface; a smaller --step may help"
        raise UserError(f"the measuring run ended with {ended[0]}", file=bench.rig, hint=hint)
    targets, sensor = (series.telegrams(bench.axis, name) for name in (TARGET, SECOND))
    return Run(log.signals(), targets, sensor)


class _Log:
    """Observer of the channel: notes what the control of one axis has in every cycle."""

    def __init__(self, axis: str, is_distance: bool) -> None:
        self._axis, self._is_distance = axis, is_distance
        self._rows: list[tuple[float, ...]] = []

    def __call__(self, channel: Channel) -> None:
        axis = channel.distance.axes[self._axis]
        link = next(link for link in channel.links if link.name == self._axis)
        if axis.sensor_mm is not None:
            control = axis.control
            wanted = control.set_dist_mm if self._is_distance else control.set_pos_mm
            wanted_mm = math.nan if wanted is None else wanted
            positions_mm = (link.set_mm, link.actual_mm, -axis.sensor_mm)
            self._rows.append((wanted_mm, control.offset_mm, *positions_mm))

    def signals(self) -> Signals:
        return Signals(*np.array(self._rows).reshape(-1, 5).T)
