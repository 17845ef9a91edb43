"""Machining coordinate systems (#CS)."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.coordinates import MAIN_AXES, Frame
from axisrig.kernel.nc.decoder import axes
from axisrig.kernel.nc.decoder.base.cells import whole_index
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.topic import Handler, Topic, silent
from axisrig.kernel.nc.syntax import Command, Expression, Group, Name, Number

COMPONENTS = 6
# TF5200 programming manual 208480907 and 1037259147: so many can be stored or linked at a time
SYSTEMS_MAX = 5
NAME_LENGTH_MAX = 8
RESERVED = ("ACS", "MCS", "IMCS")

Components = tuple[float, ...]
# A number, or a name as TF5200 programming manual 1086442763 has it
Id = int | str


@dataclass
class Systems:
    """What #CS keeps. stored: by ID (#CS DEF, #CS ON with an ID). last: what was defined last.

    on: the systems that are on, lowest first: ID, name, or None for one without either.
    linked: those of #CS ADD by name, lowest first.
    """

    stored: dict[Id, Components] = field(default_factory=dict)
    last: Components | None = None
    last_id: Id | None = None
    on: list[Id | None] = field(default_factory=list)
    linked: dict[str, Components] = field(default_factory=dict)


def _on(context: Context, block: Block, command: Command) -> None:
    """#CS ON: components, a stored system by its ID, both, or the one that was defined last."""
    kept = context.part(Systems)
    groups = list(_groups(command))
    if not groups:
        if kept.last is None:
            raise context.alarm(20821, block, word="#CS ON")
        _switch_on(context, kept.last, kept.last_id)
    elif len(groups) == 1 and len(groups[0].arguments) == 1:
        chosen = _id(context, block, groups[0])
        if chosen not in kept.stored:
            raise context.alarm(20821, block, word=f"#CS ON[{chosen}]")
        _switch_on(context, kept.stored[chosen], chosen)
    else:
        number, components = _define(context, block, groups)
        _switch_on(context, components, number)


def _store(context: Context, block: Block, command: Command) -> None:
    """#CS DEF: components with an ID, or with the next one that is free."""
    groups = list(_groups(command))
    number, components = _define(context, block, groups)
    if number is None:
        kept = context.part(Systems)
        number = next(i for i in range(1, SYSTEMS_MAX + 1) if i not in kept.stored)
        kept.stored[number], kept.last_id = components, number


def _define(context: Context, block: Block, groups: list[Group]) -> tuple[Id | None, Components]:
    """Take the definition of a system: its ID where it has one, and its components."""
    kept = context.part(Systems)
    number = _id(context, block, groups[0]) if len(groups) > 1 else None
    components = _components(context, block, groups[-1])
    unnamed = sum(1 for one in kept.on if one is None)
    if number not in kept.stored and len(kept.stored) + unnamed >= SYSTEMS_MAX:
        raise context.alarm(
            21234, block, word="#CS", value=len(kept.stored) + unnamed + 1, upper=SYSTEMS_MAX
        )
    if number is not None:
        kept.stored[number] = components
    kept.last, kept.last_id = components, number
    return number, components


def _switch_on(context: Context, components: Components, name: Id | None) -> None:
    context.coordinates.switch_on(Frame.of(components))
    context.part(Systems).on.append(name)


def _off(context: Context, block: Block, command: Command) -> None:
    if not context.coordinates.transformed:
        raise context.alarm(900108, block)
    context.coordinates.switch_off()
    context.part(Systems).on.pop()


def _all_off(context: Context, block: Block, command: Command) -> None:
    context.coordinates.switch_off_all()
    context.part(Systems).on.clear()


def _link(context: Context, block: Block, command: Command) -> None:
    """#CS ADD: a named system on top of those added before; #CS SELECT takes it into use."""
    kept = context.part(Systems)
    first, second = _groups(command)
    name = _name(first)
    if name in RESERVED or name in kept.linked or len(name) > NAME_LENGTH_MAX:
        raise context.alarm(21599, block, name=name)
    if len(kept.linked) >= SYSTEMS_MAX:
        raise context.alarm(
            21234, block, word="#CS ADD", value=len(kept.linked) + 1, upper=SYSTEMS_MAX
        )
    kept.linked[name] = _components(context, block, second)


def _select(context: Context, block: Block, command: Command) -> None:
    """#CS SELECT: the named system and those below it are on, and nothing else."""
    kept = context.part(Systems)
    (group,) = _groups(command)
    name = _known(context, block, _name(group))
    context.coordinates.switch_off_all()
    kept.on.clear()
    for linked, components in kept.linked.items():
        _switch_on(context, components, linked)
        if linked == name:
            break


def _change(context: Context, block: Block, command: Command) -> None:
    """#CS SET: another place for a named system, also while it or one above it is on."""
    kept = context.part(Systems)
    first, second = _groups(command)
    name = _known(context, block, _name(first))
    kept.linked[name] = _components(context, block, second)
    if name in kept.on:
        context.coordinates.redefine(kept.on.index(name) + 1, Frame.of(kept.linked[name]))


def _known(context: Context, block: Block, name: str) -> str:
    linked = context.part(Systems).linked
    if name in RESERVED:
        raise context.not_acting(block, f"#CS SELECT[{name}]", "system of a kinematic")
    if name not in linked:
        raise context.alarm(21601, block, name=name, known=" ".join(linked) or "none")
    return name


def _groups(command: Command) -> Iterator[Group]:
    for argument in command.arguments:
        assert isinstance(argument, Group)
        yield argument


def _name(group: Group) -> str:
    """Give the name in a bracket; a number is one too."""
    match group.arguments[:1]:
        case (Name(word),):
            return word
        case (Number(value),):
            return f"{value:g}"
    return "[]"


def _id(context: Context, block: Block, group: Group) -> Id:
    first = group.arguments[0] if group.arguments else None
    if isinstance(first, Name):
        return first.value
    value = context.value(block, first) if isinstance(first, Expression) else 0.0
    number = whole_index(value)
    if not number:
        raise context.alarm(20820, block, value=f"{value:.10g}")
    return number


def _components(context: Context, block: Block, group: Group) -> Components:
    """Three shifts in mm and three angles in degrees; what is left out is 0."""
    values = [0.0] * COMPONENTS
    for place, argument in enumerate(group.arguments[:COMPONENTS]):
        if isinstance(argument, Expression):
            unit = context.unit_mm if place < MAIN_AXES else 1.0
            values[place] = context.value(block, argument) * unit
    return tuple(values)


def _turning(act: Callable[[Context, Block, Command], None]) -> Handler:
    """Make the handler of a command that changes the active system."""

    def handler(context: Context, block: Block, command: Command) -> Iterator[canon.Command]:
        yield from axes.turns_channel(context, block, f"#{command.name}")
        yield from axes.before_turning(context, block)
        act(context, block, command)

    return handler


TOPIC = Topic(
    commands={
        "CS ON": _turning(_on),
        "CS OFF": _turning(_off),
        "CS OFF ALL": _turning(_all_off),
        "CS DEF": silent(_store),
        "CS ADD": silent(_link),
        "CS SELECT": _turning(_select),
        "CS SET": _turning(_change),
    }
)
