"""Variables of the PLC side (V.E.)."""

from collections.abc import Mapping

from kernel.errors import UserError, nearest
from kernel.nc.canon import Block
from kernel.nc.decoder.context import Context
from kernel.nc.syntax import Program


def read(context: Context, block: Block, name: str) -> float:
    """Give the present value of V.E.<name>; upper and lower case do not differ."""
    spelled = next(known for known in context.external if known.upper() == name)
    return float(context.external[spelled])


def check(program: Program, external: Mapping[str, float]) -> None:
    """Refuse a program that reads a V.E. variable which the PLC side does not have."""
    known_names = {name.upper() for name in external}
    for name, line, column in program.variables:
        key = name.removeprefix("V.E.")
        if name.startswith("V.E.") and key not in known_names:
            close = nearest(key, external)
            raise UserError(
                "the PLC side has no such variable",
                file=program.file,
                line=line,
                column=column,
                value=name,
                allowed=[f"V.E.{known}" for known in external] or "none",
                hint=f"did you mean {', '.join(f'V.E.{k}' for k in close)}"
                if close
                else f"give it one: a column plc:{name}, or --set plc:{name}=<value>",
            )
