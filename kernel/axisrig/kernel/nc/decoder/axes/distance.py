"""DIST_CTRL and #DIST CTRL: words for the distance control of an axis and for that of the channel;
what a control that is on forbids.

The words of a block act in their order, before its motion. Sources: FCT-M3 6; TF5200 distance
control 290203275, programming manual 208654987, diagnosis 1257123723; FCT-M3 12.2.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final

from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.axes.state import forbidden
from axisrig.kernel.nc.decoder.axes.values import number, shown
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.variables.external import spelled_by_plc
from axisrig.kernel.nc.decoder.variables.own import spelled
from axisrig.kernel.nc.expressions import whole_number
from axisrig.kernel.nc.syntax import AxisCommand, Command, Name, Option, Text, Variable
from axisrig.kernel.parameters.table import Parameter, table

NAME: Final = "DIST_CTRL"
ACTIONS: Final = {
    "ON": "on",
    "DRYRUN": "on",
    "OFF": "off",
    "FREEZE": "freeze",
    "CHECK_POS": "check",
    "REF": "ref",
}
FREE_VALUES: Final = ("VAL1", "VAL2", "VAL3", "VAL4", "VAL5")
FIELD: Final = "V.E."
HASH: Final = "#DIST CTRL"
_OF_AXIS: Final = "kenngr.dist_ctrl[0]."
_OF_CHANNEL: Final = "dist_ctrl[0]."


@dataclass(frozen=True)
class _Parameter:
    """A keyword that sets a parameter.

    name: in `DistanceControl.program`. path: whose range counts, after `dist_ctrl[0].`; empty where
    the control itself looks whether it can be (310001, 310003). is_time: a time in s above 0.
    """

    name: str
    path: str = ""
    is_whole: bool = False
    is_time: bool = False


# DISTC_N_CYCLES and DISTC_ORDER: TF5200 diagnosis 1097719947 and 882893195
_PARAMETERS: Final[Mapping[str, _Parameter]] = {
    "KP": _Parameter("kp", "kp"),
    "I_TN": _Parameter("tn_s", "i_tn"),
    "D_TV": _Parameter("tv_s", "d_tv"),
    "N_CYCLES": _Parameter("n_cycles", is_whole=True),
    "DISTC_N_CYCLES": _Parameter("n_cycles", is_whole=True),
    "FG_F0": _Parameter("low_pass_filter_fg_f0"),
    "ORDER": _Parameter("low_pass_filter_order", "low_pass_filter_order", is_whole=True),
    "DISTC_ORDER": _Parameter("low_pass_filter_order", "low_pass_filter_order", is_whole=True),
    "SMOOTH_FACT": _Parameter("smoothing_factor"),
    "KALMAN_SIGMA": _Parameter("kalman_sigma"),
    "FILTER_TIME": _Parameter("filter_time_s", is_time=True),
}


def control(context: Context, block: Block, command: AxisCommand) -> Iterator[canon.Command]:
    """`Z[DIST_CTRL ..]`; after OFF NO_MOVE the program counts from where the axis is.

    Raises Alarm 22096, 22142, 22349 and 900300; 900196 for a slave that is to be switched on.
    """
    axis = command.axis
    wanted = _wanted(context, block, dict(command.options), axis)
    alarm = forbidden(context, block, axis) if wanted.action in ("on", "on_const") else None
    if alarm is not None:
        raise alarm
    yield wanted
    if wanted.no_move:
        yield from _begin_where_they_are(context, block, (axis,))


def channel_control(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """`#DIST CTRL`: 3D control; after OFF NO_MOVE the program counts from where the axes are.

    Raises Alarm 20209 without P-CHAN-00500, 21837 without the option, 22356 for WP_ORIENTATION, of
    which no source lists the values, 900467 for a rotary axis; the others as `control`.
    """
    known = context.machine.channel_distance()
    if known is None:
        raise context.alarm(20209, block, word=HASH)
    if not known.is_licensed:
        raise context.alarm(21837, block, word=HASH)
    options = dict(command.options)
    if "WP_ORIENTATION" in options:
        value = shown(context, block, options["WP_ORIENTATION"])
        raise context.alarm(22356, block, value=value)
    direction = _name(options.get("DIRECTION"))
    if direction in context.tables.rotary:
        linear = " ".join(axis for axis in context.axes if axis not in context.tables.rotary)
        raise context.alarm(900467, block, axis=direction, linear=linear or "none")
    x, y, z = (*context.coordinates.origin_acs_mm, 0.0, 0.0, 0.0)[:3]
    wanted = replace(
        _wanted(context, block, options, None),
        mode=_name(options.get("MODE")),
        direction=direction,
        normal=context.coordinates.normal_acs,
        origin_mm=(x, y, z),
    )
    yield wanted
    if wanted.no_move:
        yield from _begin_where_they_are(context, block, context.axes)


def _wanted(
    context: Context, block: Block, options: Mapping[str, Option], axis: str | None
) -> canon.DistanceCommand:
    """Give what the keywords say to the control of an axis, or to that of the channel."""
    action = next((ACTIONS[word] for word in options if word in ACTIONS), None)
    if axis is not None and not options:
        action = ACTIONS["OFF"]  # which may be left out
    return canon.DistanceCommand(
        block,
        axis,
        "on_const" if "CONST_DIST" in options else action,
        wait="WAIT" in options,
        no_move="NO_MOVE" in options,
        dry_run="DRYRUN" in options,
        set_pos_mm=_length(context, block, axis, options.get("SET_POS")),
        set_dist_mm=_length(context, block, axis, options.get("SET_DIST")),
        parameters=dict(_parameters(context, block, axis, options)),
        sensor_source=_name(options.get("SENSOR_SOURCE")),
        sensor_variable=_variable(context, block, options.get("SENSOR_VAR")),
        values=tuple(number(context, block, options.get(word)) for word in FREE_VALUES),
    )


def _begin_where_they_are(
    context: Context, block: Block, axes: Iterable[str]
) -> Iterator[canon.Command]:
    yield canon.Wait(block)
    at = context.machine.position_acs_mm
    context.coordinates.begin_at({axis: at(axis) for axis in axes})


def _length(context: Context, block: Block, axis: str | None, option: Option) -> float | None:
    value = number(context, block, option)
    if value is None:
        return None
    return value * context.unit_mm if axis is None else context.mm(axis, value)


def _name(option: Option) -> str | None:
    return option.value if isinstance(option, Name) else None


def _variable(context: Context, block: Block, option: Option) -> str | None:
    """Give the variable as the PLC side spells it, without `V.E.`; as programmed if it has none."""
    if not isinstance(option, Variable):
        return None
    written = spelled(option.name, tuple(context.indices(block, option)))
    known = None
    if written.startswith(FIELD):
        known = spelled_by_plc(context, written.removeprefix(FIELD))
    return written if known is None else known


def _parameters(
    context: Context, block: Block, axis: str | None, options: Mapping[str, Option]
) -> Iterator[tuple[str, float | str]]:
    """Give the parameters of the command under their names in the control."""
    for keyword, option in options.items():
        if keyword == "FILTER_TYPE" and isinstance(option, Name):
            yield "filter_type", option.value
        elif keyword == "BOTH_ENCODER":
            is_number = not isinstance(option, Text)
            value = number(context, block, option) if is_number else None
            wanted = None if value is None else whole_number(value)
            if wanted not in (0, 1):
                raise context.alarm(22349, block, value=shown(context, block, option))
            yield "both_encoders", bool(wanted)
        elif keyword in _PARAMETERS:
            yield _PARAMETERS[keyword].name, _value(context, block, axis, keyword, option)


def _value(context: Context, block: Block, axis: str | None, keyword: str, option: Option) -> float:
    """Give the number after a keyword; raises Alarm 22096, 22142 and 900300 for a wrong one."""
    known = _PARAMETERS[keyword]
    value = number(context, block, option)
    assert value is not None, "the table of commands has checked it"
    scope, prefix = ("channel", _OF_CHANNEL) if axis is None else ("axis", _OF_AXIS)
    row: Parameter | None = table(scope).find(prefix + known.path)[0] if known.path else None
    whole = whole_number(value) if known.is_whole else None
    taken = value if whole is None else whole
    fits = row is None or row.is_within(taken)
    if known.is_time:
        fits = taken > 0
    if fits and not (known.is_whole and whole is None):
        return taken
    if row is None or row.minimum is None or row.maximum is None:
        allowed = "above 0" if known.is_time else "whole numbers"
    elif known.name == "tn_s":
        raise context.alarm(22096, block, value_s=value, low_s=row.minimum, high_s=row.maximum)
    elif known.name == "low_pass_filter_order":
        raise context.alarm(22142, block, value=f"{value:g}", low=row.minimum, high=row.maximum)
    else:
        allowed = row.allowed
    owner = "the channel" if axis is None else f"axis {axis}"
    raise context.alarm(
        900300, block, keyword=keyword, value=f"{value:g}", owner=owner, allowed=allowed
    )


# ---- what else is in the program while a control is on

OFF_STATE: Final = "INACTIVE"
HOLDING: Final = (OFF_STATE, "FREEZE")
# On which positions the offset is superposed: those of the axis itself
PLANE: Final = "ACS"


def known_states(context: Context, block: Block, axes: Iterable[str]) -> Iterator[canon.Command]:
    """Wait until the states of the controls of these axes are those that the block finds."""
    if any(context.machine.distance_state(axis) is not None for axis in axes):
        yield canon.Wait(block)


def must_stay(context: Context, block: Block, axis: str) -> Alarm | None:
    """Give the alarm of an axis that is to leave the channel while its control is on."""
    state = context.machine.distance_state(axis)
    return None if state in (None, OFF_STATE) else context.alarm(70333, block, axis=axis)


def initialises(
    context: Context, block: Block, axes: Iterable[str], word: str
) -> Iterator[canon.Command]:
    """Refuse to initialise positions of axes whose offset changes; raises Alarm 51062."""
    axes = tuple(axes)
    yield from known_states(context, block, axes)
    for axis in axes:
        if context.machine.distance_state(axis) not in (None, *HOLDING):
            raise context.alarm(51062, block, word=word, plane=PLANE)


def turns_channel(context: Context, block: Block, word: str) -> Iterator[canon.Command]:
    """Refuse what begins the position of the channel anew while the offset of 3D control changes.

    Source: FCT-M3 12.4.5. Raises Alarm 51062.
    """
    if context.machine.channel_distance() is None:
        return
    yield canon.Wait(block)
    known = context.machine.channel_distance()
    if known is not None and known.plane is not None:
        raise context.alarm(51062, block, word=word, plane=known.plane)
