"""What a topic of the decoder provides: the words, commands and variables that it handles."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.expressions import Value

# The third argument is the statement: Words for a word, Command for a # command, AxisCommand.
Handler = Callable[[Context, Block, Any], Iterator[canon.Command]]
# (context, block, what follows the stem, *indices): the axis in upper case, or any name.
Reader = Callable[..., Value]
# (context, block, what follows the stem, value, *indices)
Writer = Callable[..., Iterator[canon.Command]]


@dataclass(frozen=True)
class Topic:
    """The tables of one module; `registry` puts those of all modules together.

    A block of words is worked off in this order: settings, addresses, commands to single axes,
    axis words, endings. What nobody handles ends with alarm 900100.

    statements: by class of statement. commands: # commands by name, upper case with single blanks.
    axis_commands: by first word (`INDP_SYN`). addresses: by letter (`F`, `T`), those that act
    before the axis words, once for each block. read_addresses: letters that a G function reads.
    settings: G and M functions that act before everything else: G70 counts for the F of its block.
    takes_axes: G functions that take the axis words of their block. endings: M functions that act
    after the axis words. readers, writers: variables by the stem before `<axis>` or `<name>`
    in variables.csv, without the point; a name with indices has `[]` for each
    (`V.G.KIN_STEP[].ID[].PARAM[]`).
    """

    statements: Mapping[type, Handler] = field(default_factory=dict)
    commands: Mapping[str, Handler] = field(default_factory=dict)
    axis_commands: Mapping[str, Handler] = field(default_factory=dict)
    addresses: Mapping[str, Handler] = field(default_factory=dict)
    settings: Mapping[str, Handler] = field(default_factory=dict)
    takes_axes: Mapping[str, Handler] = field(default_factory=dict)
    endings: Mapping[str, Handler] = field(default_factory=dict)
    readers: Mapping[str, Reader] = field(default_factory=dict)
    writers: Mapping[str, Writer] = field(default_factory=dict)
    read_addresses: tuple[str, ...] = ()


def silent(act: Callable[[Context, Block, Any], None]) -> Handler:
    """Make a handler of something that gives the machine nothing to do."""

    def handler(context: Context, block: Block, statement: Any) -> Iterator[canon.Command]:
        act(context, block, statement)
        return iter(())

    return handler
