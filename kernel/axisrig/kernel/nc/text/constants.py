"""Blocks whose constants alone show that a run ends at them with an alarm.

The decoder raises the alarm when it gets there; a check reports it before. What depends on a
variable, or on what is in other blocks, shows in a run only.
"""

import math
from collections.abc import Iterator, Sequence

from axisrig.kernel.nc.syntax import AxisCommand, Number, ProgramBlock, Words

# P-CHAN-00041: m_synch[i] with i from 0 to 999
M_NUMBER_MAX = 999
_CENTRE = ("I", "J", "K", "R")
_INDEPENDENT = ("INDP_SYN", "INDP_ASYN")
_SPEEDS = ("FEED", "TIME", "FEED_MAX_WEIGHT")
_PERCENT = 100.0


def ending_words(parts: Sequence[ProgramBlock], first_axis: str) -> Iterator[tuple[int, int, str]]:
    """Give line, column and what is wrong, with the ID of the alarm, for each such block.

    first_axis: the main axis whose word may hold the time of G4.
    """
    # A radius stays for the arcs after it, also one of a subprogram in another file
    has_radius = any(
        isinstance(part.statement, Words) and part.statement.address("R") is not None
        for part in parts
    )
    for part in parts:
        if isinstance(part.statement, Words):
            found = [*_of_words(part.statement, first_axis, has_radius)]
            for command in part.statement.axis_commands:
                found += _of_axis(command)
            for text in found:
                yield part.block.line, part.block.column, text


def _of_words(words: Words, first_axis: str, has_radius: bool) -> Iterator[str]:
    tool = words.address("D")
    if isinstance(tool, Number) and tool.value < 0:
        yield f"D{tool.value:g} is no tool (ID 900155)"
    for m in words.m:
        if int(m[1:]) > M_NUMBER_MAX:
            yield f"{m} is no M function: the last is M{M_NUMBER_MAX} (ID 20160)"
    if "G4" in words.g:
        time = dict(words.axes).get(first_axis) or words.address("G4")
        if time is None:
            yield "G4 has no dwell time (ID 900171)"
        elif isinstance(time, Number) and time.value < 0:
            yield "G4 has a dwell time below 0 (ID 20752)"
    arc = next((g for g in words.g if g in ("G2", "G3")), None)
    if arc and words.axes and not has_radius and not any(map(words.address, _CENTRE)):
        yield f"{arc} has neither a centre (I J K) nor a radius R (ID 20036)"


def _of_axis(command: AxisCommand) -> Iterator[str]:
    if command.name not in _INDEPENDENT:
        return
    shown = f"{command.axis}[{command.name} ..]"
    written = dict(command.options)
    is_rapid = "G0" in written
    if is_rapid and "G1" in written:
        yield f"{shown} has G0 and G1 at a time (ID 900194)"
        return
    speeds = [word for word in _SPEEDS if word in written]
    if is_rapid and speeds:
        yield f"{shown} has {speeds[0]} with G0 (ID 50603)"
    # A measuring type may have a speed of its own: only a run shows whether that of the block acts
    acting = [] if is_rapid or "G100" in written else speeds
    for word in (*acting, "RAPID_ACC_WEIGHT" if is_rapid else "ACC_WEIGHT"):
        value = written.get(word)
        most = _PERCENT if word.endswith("WEIGHT") else math.inf
        if isinstance(value, Number) and not 0.0 < value.value <= most:
            allowed = f"above 0{'' if most == math.inf else f' and at most {most:g}'}"
            yield f"{shown} has {word}={value.value:g}, which has to be {allowed} (ID 50603)"
