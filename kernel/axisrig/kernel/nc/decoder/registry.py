"""All topics put together: which handler takes which word, command and variable."""

from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import TypeVar

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder import axes, kinematics, systems
from axisrig.kernel.nc.decoder import variables as variables_
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Handler, Reader, Writer
from axisrig.kernel.nc.decoder.base.walk import read_by
from axisrig.kernel.nc.decoder.topics import (
    circles,
    drives,
    flow,
    measuring,
    messages,
    motion,
    offsets,
    pauses,
    probes,
    slopes,
    technology,
    tools,
)
from axisrig.kernel.nc.expressions import Value
from axisrig.kernel.nc.syntax import Statement, Variable
from axisrig.kernel.nc.text.words import find_variable

Key = TypeVar("Key")
Item = TypeVar("Item")

TOPICS = tuple(
    module.TOPIC
    for module in (
        motion,
        slopes,
        pauses,
        circles,
        measuring,
        probes,
        systems,
        offsets,
        tools,
        kinematics,
        axes,
        drives,
        messages,
        flow,
        variables_,
    )
)


def _together(tables: Iterable[Mapping[Key, Item]]) -> Mapping[Key, Item]:
    whole: dict[Key, Item] = {}
    for table in tables:
        twice = whole.keys() & table.keys()
        assert not twice, f"two topics handle {twice}"
        whole.update(table)
    return whole


STATEMENTS: Mapping[type, Handler] = _together(topic.statements for topic in TOPICS)
COMMANDS: Mapping[str, Handler] = _together(topic.commands for topic in TOPICS)
AXIS_COMMANDS: Mapping[str, Handler] = _together(topic.axis_commands for topic in TOPICS)
ADDRESSES: Mapping[str, Handler] = _together(topic.addresses for topic in TOPICS)
SETTINGS: Mapping[str, Handler] = _together(topic.settings for topic in TOPICS)
TAKES_AXES: Mapping[str, Handler] = _together(topic.takes_axes for topic in TOPICS)
ENDINGS: Mapping[str, Handler] = _together(topic.endings for topic in TOPICS)
READERS: Mapping[str, Reader] = _together(topic.readers for topic in TOPICS)
WRITERS: Mapping[str, Writer] = _together(topic.writers for topic in TOPICS)
# Letters whose values are taken by something else than a handler of their own
READ_ADDRESSES = (*technology.SENT, *(a for topic in TOPICS for a in topic.read_addresses))


@cache
def _stem(name: str, *, writes: bool) -> tuple[str, str] | None:
    """Split a variable into the stem that somebody handles and what follows it."""
    table: Mapping[str, object] = WRITERS if writes else READERS
    if name in table:
        return name, ""
    parts = name.split(".")
    for count in range(len(parts) - 1, 0, -1):
        stem = ".".join(parts[:count])
        if stem in table:
            return stem, ".".join(parts[count:])
    return None


@cache
def _waits_of_name(name: str) -> str:
    row, _ = find_variable(name)
    return "" if row is None else row.waits


def waits_of(statement: Statement) -> str:
    """Return what a block waits for before it is decoded: nothing, `machine` or `cycle`.

    `machine`: until everything before it is executed. `cycle`: the same, and the next cycle.
    Source: variables.csv, column waits.
    """
    found = ""
    for variable in read_by(statement):
        waits = _waits_of_name(variable.name)
        if waits == "cycle":
            return waits
        found = found or waits
    return found


def is_read(row_name: str) -> bool:
    """Return whether somebody reads the variables of a row of variables.csv."""
    return _stem(row_name.replace("<axis>", "X").replace("<name>", "ANY"), writes=False) is not None


class Variables:
    """Reads and writes variables through the tables of the topics."""

    def read(self, context: Context, block: Block, variable: Variable) -> Value:
        """Give the value of a variable; raises Alarm 900100 for one that nobody reads."""
        found = _stem(variable.name, writes=False)
        if found is None:
            raise _unhandled(context, block, variable.name)
        stem, rest = found
        return READERS[stem](context, block, rest, *context.indices(block, variable))

    def write(
        self, context: Context, block: Block, variable: Variable, value: Value
    ) -> Iterator[canon.Command]:
        """Give a variable a value; raises Alarm 900121 for one that can only be read."""
        found = _stem(variable.name, writes=True)
        if found is None:
            if _stem(variable.name, writes=False) is None:
                raise _unhandled(context, block, variable.name)
            raise context.alarm(900121, block, name=variable.name)
        stem, rest = found
        indices = context.indices(block, variable)
        yield from WRITERS[stem](context, block, rest, value, *indices)


def _unhandled(context: Context, block: Block, name: str) -> Exception:
    row, _ = find_variable(name)
    return context.not_acting(block, name, "variable" if row is None else row.meaning)
