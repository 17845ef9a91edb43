"""Measuring runs, their results, and the measurement offset."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.coordinates import Measured
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Reader, Topic, silent
from axisrig.kernel.nc.decoder.base.walk import read_by
from axisrig.kernel.nc.decoder.topics import pauses
from axisrig.kernel.nc.expressions import whole_number
from axisrig.kernel.nc.measuring_types import MeasuringType, measuring_types
from axisrig.kernel.nc.syntax import Command, Expression, Statement, Words

TO_THE_TARGET = 3  # the type that goes on after the signal


@dataclass
class Measurements:
    """What measuring keeps from run to run.

    chosen_type: by #MEAS MODE, None for the default of the channel. error_no_signal: by #MEAS,
    None for P-CHAN-00176. simulated_offset_mm: by #MEAS. results, signalled: by axis. beside: axes
    that measure beside the program (INDP_SYN, INDP_ASYN) and whose results are not known yet, with
    the radius of the ball of their run, mm.
    """

    chosen_type: int | None = None
    error_no_signal: bool | None = None
    simulated_offset_mm: float = 0.0
    results: dict[str, Measured] = field(default_factory=dict)
    signalled: dict[str, bool] = field(default_factory=dict)
    beside: dict[str, float] = field(default_factory=dict)


def measuring_type(context: Context) -> int:
    """Give the measuring type in use."""
    chosen = context.part(Measurements).chosen_type
    return context.default_measuring_type if chosen is None else chosen


def _measure(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """G100: types 1 to 4 and 7. Source: FCT-C4 sections 3 and 4."""
    pauses.require_no_contouring(context, block, words)
    kind = measuring_types()[measuring_type(context)]
    if kind.command != "G100":
        raise context.alarm(20138, block, type=kind.number)
    _check_axes(context, block, kind, [axis for axis, _ in words.axes])
    goes_on = "G106" in words.g
    if goes_on and kind.number != TO_THE_TARGET:
        raise context.alarm(20772, block, g_function="G106", type=kind.number)
    feed_mm_min = None if kind.has_own_speed else context.feed(block, "G100")
    yield from _run(context, block, words, kind, feed_mm_min, goes_on=goes_on)


def _interruptible(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    """G310 (G210): types 5 and 6. Source: FCT-C4 section 3, programming manual 206197003."""
    pauses.require_no_contouring(context, block, words)
    kind = measuring_types()[measuring_type(context)]
    if kind.command != "G310":
        raise context.alarm(20956, block, type=kind.number)
    named = [axis for axis, _ in words.axes]
    if kind.needs_sercos and not any(context.machine.is_sercos(axis) for axis in named):
        raise context.alarm(900221, block, type=kind.number, axes=" ".join(named))
    _check_axes(context, block, kind, named)
    feed_mm_min = None if context.modal.motion == "G0" else context.feed(block, "G310")
    yield from _run(context, block, words, kind, feed_mm_min)
    kept, machine = context.part(Measurements), context.machine
    if not any(kept.signalled[axis] for axis in named):
        return
    measuring = [axis for axis in context.axes if machine.may_measure(axis)]
    context.coordinates.stand_at({axis: machine.actual_acs_mm(axis) for axis in measuring})
    context.coordinates.take_as_target(measuring)
    if words.goto is not None:
        context.flow.jump(words.goto.label)


def _run(
    context: Context,
    block: Block,
    words: Words,
    kind: MeasuringType,
    feed_mm_min: float | None,
    *,
    goes_on: bool = False,
) -> Iterator[canon.Command]:
    """Measure, wait for the end of the run, and keep its results."""
    values, coordinates = context.axis_values(block, words), context.coordinates
    target_mm = coordinates.aim(values, absolute=context.modal.absolute)
    if not target_mm:
        raise context.alarm(900103, block, axes=" ".join(values))
    involved = {*target_mm, *coordinates.common_axes}
    measuring = tuple(axis for axis in context.axes if axis in involved)
    yield canon.MeasuringRun(
        block,
        target_mm,
        tuple(values),
        measuring,
        feed_mm_min,
        kind.number,
        goes_on=goes_on,
        error_no_signal=context.part(Measurements).error_no_signal,
        simulated_offset_mm=context.part(Measurements).simulated_offset_mm,
    )
    yield canon.Wait(block)
    moved = dict.fromkeys((*target_mm, *coordinates.kinematic_axes))
    take_results(context, measuring, tuple(values), moved=tuple(moved))


def _check_axes(context: Context, block: Block, kind: MeasuringType, axes: Sequence[str]) -> None:
    if kind.axes_max is not None and len(axes) > kind.axes_max:
        raise context.alarm(
            50061, block, programmed=len(axes), maximum=kind.axes_max, type=kind.number
        )
    others = [axis for axis in axes if axis not in context.coordinates.main_axes]
    if kind.main_axes_only and others:
        raise context.alarm(900220, block, type=kind.number, axis=others[0])


def _without_run(context: Context, block: Block, words: Words) -> None:
    """G106 belongs to G100."""
    if "G100" not in words.g:
        raise context.alarm(900228, block)


def take_results(
    context: Context,
    measuring: Sequence[str],
    programmed: Sequence[str],
    moved: Sequence[str],
    ball_radius_mm: float | None = None,
) -> None:
    """Keep what the run gave, as seen in the coordinate system in which it took place.

    Axes that are neither measuring nor programmed keep the values of an earlier run.
    ball_radius_mm: that of the run; None for the tool in use.
    Source: FCT-C4 section 5, notice on several runs.
    """
    kept, machine = context.part(Measurements), context.machine
    context.coordinates.stand_at({axis: machine.position_acs_mm(axis) for axis in moved})
    latched_mm = {}
    for axis in dict.fromkeys((*measuring, *programmed)):
        kept.results.pop(axis, None)
        kept.signalled[axis] = axis in measuring and machine.measurement_ok(axis)
        value_mm = machine.measured_acs_mm(axis) if kept.signalled[axis] else None
        if value_mm is not None:
            latched_mm[axis] = value_mm
    radius_mm = ball_of_tool_mm(context) if ball_radius_mm is None else ball_radius_mm
    kept.results.update(context.coordinates.measured(latched_mm, ball_radius_mm=radius_mm))


def begin_beside(context: Context, axis: str) -> None:
    """Take note that an axis measures beside the program from here on: what it had is gone.

    A D before the end of the run is not the tool of the run.
    """
    kept = context.part(Measurements)
    kept.results.pop(axis, None)
    kept.signalled[axis] = False
    kept.beside[axis] = ball_of_tool_mm(context)


def end_beside(context: Context, axis: str) -> None:
    """Take what the run of an axis beside the program has delivered, once it is over."""
    ball_mm = context.part(Measurements).beside.pop(axis, None)
    if ball_mm is not None:
        take_results(context, (axis,), (axis,), moved=(axis,), ball_radius_mm=ball_mm)


def _take_ended(context: Context) -> None:
    """Take the results of the runs beside the program that have ended meanwhile."""
    for axis in list(context.part(Measurements).beside):
        if not context.machine.is_measuring(axis):
            end_beside(context, axis)


def asks_beside(context: Context, statement: Statement) -> bool:
    """Whether a statement reads a variable of an axis that may measure beside the program."""
    beside = context.part(Measurements).beside
    return bool(beside) and any(
        variable.name.rpartition(".")[2] in beside for variable in read_by(statement)
    )


def ball_of_tool_mm(context: Context) -> float:
    """Give the radius of the tool in use as far as it counts in results (P-CHAN-00311)."""
    counts = context.tables.ball_radius_counts
    return context.coordinates.tool.radius_mm if counts else 0.0


def _include_offset(context: Context, block: Block, words: Words) -> Iterator[canon.Command]:
    factors = context.axis_factors(block, words)
    _require_offset_type(context, block, "G101")
    if any(axis in context.part(Measurements).beside for axis, _ in factors):
        yield canon.Wait(block)
        _take_ended(context)
    shifts_mm = {
        axis: factor * _measured(context, block, axis, "G101").offset_mm for axis, factor in factors
    }
    for axis, shift_mm in shifts_mm.items():
        context.coordinates.include_measurement(axis, shift_mm)


def _drop_offset(context: Context, block: Block, words: Words) -> None:
    values = context.axis_factors(block, words)
    _require_offset_type(context, block, "G102")
    for axis in [axis for axis, _ in values] or context.axes:
        context.coordinates.include_measurement(axis, 0.0)


def _require_offset_type(context: Context, block: Block, g_function: str) -> None:
    type_ = measuring_type(context)
    if measuring_types()[type_].command != "G100":
        raise context.alarm(20772, block, g_function=g_function, type=type_)


def _choose_type(context: Context, block: Block, command: Command) -> None:
    """#MEAS MODE; without value the default of the channel."""
    if not command.arguments:
        context.part(Measurements).chosen_type = None
        return
    (chosen,) = command.arguments
    assert isinstance(chosen, Expression)
    choose_type(context, block, context.value(block, chosen))


def choose_type(context: Context, block: Block, value: float) -> None:
    """Measure in another type from here on; raises Alarm 900104 for none."""
    type_ = whole_number(value)
    if type_ not in measuring_types():
        raise context.alarm(900104, block, value=f"{value:.10g}")
    context.part(Measurements).chosen_type = type_


def _measured(context: Context, block: Block, axis: str, asked_by: str) -> Measured:
    _take_ended(context)
    results = context.part(Measurements).results
    if axis not in results:
        raise context.alarm(900101, block, axis=axis, name=asked_by)
    return results[axis]


def _result(stem: str, value_of: Callable[[Measured], float]) -> Reader:
    def reader(context: Context, block: Block, upper: str) -> float:
        axis = context.axis(upper)
        return context.shown(axis, value_of(_measured(context, block, axis, f"{stem}.{upper}")))

    return reader


def _signalled(context: Context, block: Block, axis: str) -> float:
    _take_ended(context)
    return float(context.part(Measurements).signalled.get(context.axis(axis), False))


def _included(context: Context, block: Block, upper: str) -> float:
    axis = context.axis(upper)
    return context.shown(axis, context.coordinates.measurement_offset_mm(axis))


def _type(context: Context, block: Block, rest: str) -> float:
    return float(measuring_type(context))


TOPIC = Topic(
    commands={"MEAS MODE": silent(_choose_type)},
    settings={"G106": silent(_without_run)},
    takes_axes={
        "G100": _measure,
        "G210": _interruptible,
        "G310": _interruptible,
        "G101": _include_offset,
        "G102": silent(_drop_offset),
    },
    readers={
        "V.G.MEAS_TYPE": _type,
        "V.A.MERF": _signalled,
        "V.A.MEIN": _included,
        "V.A.MESS": _result("V.A.MESS", lambda measured: measured.mess_mm),
        "V.A.MEAS.ACS.VALUE": _result("V.A.MEAS.ACS.VALUE", lambda measured: measured.acs_mm),
        "V.A.MEAS.PCS.VALUE": _result("V.A.MEAS.PCS.VALUE", lambda measured: measured.pcs_mm),
        "V.A.MOFFS": _result("V.A.MOFFS", lambda measured: measured.offset_mm),
    },
)
