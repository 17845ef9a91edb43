"""Variables that the program makes itself."""

from dataclasses import dataclass, field

from kernel.nc.canon import Block
from kernel.nc.decoder.context import Context


@dataclass
class OwnVariables:
    """Values by full name in upper case."""

    values: dict[str, float] = field(default_factory=dict)


def read(context: Context, block: Block, name: str) -> float:
    """Give V.P.<name>; raises Alarm 900113 for one that was never written."""
    values, full = context.part(OwnVariables).values, f"V.P.{name}"
    if full not in values:
        raise context.alarm(900113, block, name=full)
    return values[full]
