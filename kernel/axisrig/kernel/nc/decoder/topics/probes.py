"""#MEAS: measuring type, missing signal, and what signal each axis measures with.

Settings hold until the program ends. Sources: programming manual 207092107, FCT-C4 section 7.2.
"""

from collections.abc import Iterator

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Topic
from axisrig.kernel.nc.decoder.topics.measuring import Measurements, choose_type
from axisrig.kernel.nc.expressions import whole_number
from axisrig.kernel.nc.syntax import Command, Expression, Name, Option

INPUT_MAX = 255  # of external hardware, a drive has 2: FCT-C4 8.2.2, P-AXIS-00517
PROBES = {"PROBE0": 0, "PROBE1": 1}


def _settings(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    kept = context.part(Measurements)
    if command.has("TYPE"):
        choose_type(context, block, _number(context, block, command.option("TYPE")))
    if command.has("ERR_NO_SIGNAL"):
        kept.error_no_signal = _error_no_signal(context, block, command.option("ERR_NO_SIGNAL"))
    if command.has("SIMU_OFFSET"):
        offset = _number(context, block, command.option("SIMU_OFFSET"))
        kept.simulated_offset_mm = offset * context.unit_mm
    for axis in _axes(context, block, command):
        yield _of_axis(context, block, axis, command)


def _axes(context: Context, block: Block, command: Command) -> list[str]:
    """Give the axes that a command names; raises Alarm 20312 for a number that no axis has."""
    axes = []
    for keyword, value in command.options:
        if keyword == "AX" and isinstance(value, Name):
            axes.append(context.axis(value.value.upper()))
        elif keyword == "AXNR":
            assert isinstance(value, Expression), "the table of commands has checked it"
            axes.append(context.numbered_axis(block, value))
    return axes


def _number(context: Context, block: Block, value: Option) -> float:
    assert isinstance(value, Expression), "the table of commands has checked it"
    return context.value(block, value)


def _error_no_signal(context: Context, block: Block, value: Option) -> bool:
    chosen = _number(context, block, value)
    wanted = whole_number(chosen)
    if wanted not in (0, 1):
        raise context.alarm(
            900227, block, keyword="ERR_NO_SIGNAL", value=f"{chosen:g}", allowed="0 1"
        )
    return bool(wanted)


def _of_axis(context: Context, block: Block, axis: str, command: Command) -> canon.ProbeSettings:
    edge = command.option("EDGE")
    probe_input, probe = _input(context, block, command.option("INPUT"))
    name = edge.value.upper() if isinstance(edge, Name) else None
    signal = command.option("SIGNAL")
    source = signal.value.upper() if isinstance(signal, Name) else None
    return canon.ProbeSettings(block, axis, name, probe_input, probe, source)


def _input(context: Context, block: Block, value: Option) -> tuple[int | None, int | None]:
    """Give the input, or the number of the probe that means one."""
    if value is None:
        return None, None
    if isinstance(value, Name):
        written: object = value.value
        if value.value.upper() in PROBES:
            return None, PROBES[value.value.upper()]
    else:
        given = _number(context, block, value)
        number = whole_number(given)
        if number is not None and 1 <= number <= INPUT_MAX:
            return number, None
        written = f"{given:.10g}"
    allowed = " ".join((f"1 .. {INPUT_MAX}", *PROBES))
    raise context.alarm(900227, block, keyword="INPUT", value=written, allowed=allowed)


def _prepare(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    yield canon.PrepareProbe(block, tuple(_axes(context, block, command)))


def _default(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
    """#MEAS DEFAULT: everything as the lists have it."""
    kept = context.part(Measurements)
    kept.chosen_type = kept.error_no_signal = None
    kept.simulated_offset_mm = 0.0
    yield canon.DefaultProbes(block)


TOPIC = Topic(
    commands={"MEAS": _settings, "MEAS PREPARE": _prepare, "MEAS DEFAULT": _default},
)
