"""Variables of the PLC side (V.E.).

A value is read when the machining has got to the block, and given out when it gets there.
Source: TF5200 external variables 1091998347 (synchronous access).
"""

import re
from collections.abc import Iterator, Mapping
from math import isfinite

from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.subprograms import Unit, reachable
from axisrig.kernel.nc.decoder.base.waiting import Waiting
from axisrig.kernel.nc.decoder.variables.own import nearest_with_value, spelled
from axisrig.kernel.nc.expressions import Value

_INDEX = re.compile(r"\[[^\[\]]*\]")


def read(context: Context, block: Block, name: str, *indices: int) -> float:
    """Give the present value of V.E.<name>; upper and lower case do not differ.

    Raises Alarm 900105 for a value that the PLC side has, and that is no finite number.
    """
    known = _known(context, block, name, indices)
    context.part(Waiting).asked[f"V.E.{known}"] = None
    value = float(context.external[known])
    if not isfinite(value):
        reason = f"V.E.{known} of the PLC side is {value}, and has to be a finite number"
        raise context.alarm(900105, block, reason=reason)
    return value


def write(
    context: Context, block: Block, name: str, value: Value, *indices: int
) -> Iterator[canon.Command]:
    """Give out a value when the machining gets to the block.

    Raises Alarm 900121 for what the kernel itself shows of the tool under 3D distance control.
    """
    known = _known(context, block, name, indices)
    if known in canon.SHOWN_OF_TOOL and context.machine.channel_distance() is not None:
        raise context.alarm(900121, block, name=f"V.E.{known}")
    if isinstance(value, str):
        raise context.alarm(900122, block, name=f"V.E.{known}", kind="a number", value=value)
    yield canon.ExternalWrite(block, known, value)


def _known(context: Context, block: Block, name: str, indices: tuple[int, ...]) -> str:
    """Give the name as the PLC side spells it."""
    asked = spelled(name, indices)
    known = spelled_by_plc(context, asked)
    if known is None:
        close = nearest(asked, context.external)
        near = nearest_with_value([f"V.E.{other}" for other in close])
        raise context.alarm(900113, block, name=f"V.E.{asked}", near=near)
    return known


def spelled_by_plc(context: Context, asked: str) -> str | None:
    """Give a name (after `V.E.`, upper case) as the PLC side spells it; None if it has none."""
    return next((other for other in context.external if other.upper() == asked), None)


def check(main: Unit, external: Mapping[str, float]) -> None:
    """Refuse a program with a V.E. variable which the PLC side does not have."""
    known_names = {_INDEX.sub("[]", name.upper()) for name in external}
    for unit in reachable(main):
        for name, line, column in unit.program.variables:
            if not name.startswith("V.E."):
                continue
            key = name.removeprefix("V.E.")
            if key in known_names:
                continue
            close = nearest(key, external)
            raise UserError(
                "the PLC side has no such variable",
                file=unit.program.file,
                line=line,
                column=column,
                value=name,
                allowed=[f"V.E.{known}" for known in external] or "none",
                hint=f"did you mean {', '.join(f'V.E.{k}' for k in close)}"
                if close
                else f"give it one: a column plc:{name}, or --set plc:{name}=<value>",
            )
