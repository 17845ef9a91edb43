"""Variables that the program makes itself: V.P, V.L, V.S, P parameters and those of cycles.

V.P and P live as long as the program, V.L as long as the subprogram that made it and in what that
one calls, V.S as long as the session, @P and @S as long as the call of their cycle. #VAR gives a
type, sizes and first values; an assignment makes a single value without. Source: TF5200 programming
manual 207981323 (V.L and #VAR), 206859019 (@P).
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NoReturn

from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc import canon
from axisrig.kernel.nc.block import Block
from axisrig.kernel.nc.decoder.base.cells import RANGES, STRING, Cell, Store, whole_index
from axisrig.kernel.nc.decoder.base.context import Context
from axisrig.kernel.nc.decoder.base.subprograms import Unit, reachable
from axisrig.kernel.nc.decoder.base.topic import Reader, Topic, Writer, silent
from axisrig.kernel.nc.decoder.base.walk import written_by
from axisrig.kernel.nc.expressions import Value
from axisrig.kernel.nc.syntax import Assign, Command, Declare, For

ELEMENTS_MAX = 1_000_000
PARAMETER = "P[]"
OF_CYCLES = ("@P[]", "@S[]")


@dataclass
class OwnVariables:
    """The stores of V.P and P, and of V.S; those of V.L belong to the open calls."""

    program: Store = field(default_factory=dict)
    kept: Store = field(default_factory=dict)


def _stores(context: Context, name: str) -> list[Store]:
    """Give the stores in which a variable may be, the innermost first."""
    own = context.part(OwnVariables)
    if name.startswith("V.S."):
        return [own.kept]
    if name.startswith("V.L."):
        return [frame.local for frame in reversed(context.flow.frames)]
    if name in OF_CYCLES:
        unit = context.flow.frame.routine.unit
        frames = [frame for frame in reversed(context.flow.frames) if frame.routine.unit is unit]
        return [frame.cycle for frame in frames if frame.cycle is not None][:1]
    return [own.program]


def _find(context: Context, name: str) -> Cell | None:
    return next((store[name] for store in _stores(context, name) if name in store), None)


def _read(context: Context, block: Block, name: str, indices: tuple[int, ...]) -> Value:
    _check_place(context, block, name, indices)
    cell = _find(context, name)
    if cell is not None:
        _check_indices(context, block, name, cell, indices)
        if indices in cell.values:
            return cell.values[indices]
    raise context.alarm(
        900113, block, name=spelled(name, indices), near=_near(context, name, indices)
    )


def _check_place(context: Context, block: Block, name: str, indices: tuple[int, ...]) -> None:
    """Refuse @P and @S outside the program of a cycle. Source: TF5200 diagnosis 254440587."""
    if name in OF_CYCLES and not _stores(context, name):
        raise context.alarm(21382, block, name=spelled(name, indices))


def _near(context: Context, name: str, indices: tuple[int, ...]) -> str:
    """Return which variables that have a value look like the one that has none."""
    known = [
        spelled(other, place)
        for store in _stores(context, name)
        for other, cell in store.items()
        for place in itertools.islice(cell.values, 20)
    ]
    close = nearest(spelled(name, indices), known)
    return nearest_with_value(close)


def nearest_with_value(names: Sequence[str]) -> str:
    """Say for an alarm which names look alike and have a value."""
    return (
        f"the nearest with one: {', '.join(names)}"
        if names
        else "nothing has written it or a name like it"
    )


def spelled(name: str, indices: Sequence[int | str]) -> str:
    """Write a variable as a program does: `P[]` with 7 is P7, `V.P.A[]` with 2 is V.P.A[2]."""
    if name in (PARAMETER, *OF_CYCLES):
        return f"{name.removesuffix('[]')}{indices[0]}"
    for index in indices:
        name = name.replace("[]", f"[{index}]", 1)
    return name


def store(
    context: Context, block: Block, name: str, value: Value, indices: tuple[int, ...] = ()
) -> None:
    """Give a variable a value, making it where it does not exist yet."""
    _check_place(context, block, name, indices)
    cell = _find(context, name)
    if cell is None:
        cell = _stores(context, name)[0].setdefault(name, Cell())
    _check_indices(context, block, name, cell, indices)
    cell.values[indices] = _fitting(context, block, spelled(name, indices), cell.kind, value)


def _check_indices(
    context: Context, block: Block, name: str, cell: Cell, indices: tuple[int, ...]
) -> None:
    for index, size in zip(indices, cell.sizes or (), strict=False):
        if index >= size:
            raise context.alarm(
                20403, block, name=spelled(name, indices), value=index, lower=0, upper=size - 1
            )


def _fitting(context: Context, block: Block, shown: str, kind: str | None, value: Value) -> Value:
    """Give the value as the type takes it; a whole number loses its fraction."""
    if kind is None:
        return value
    if isinstance(value, str) is not (kind == STRING):
        raise context.alarm(900122, block, name=shown, kind=kind, value=value)
    if isinstance(value, str) or kind not in RANGES:
        return value
    lower, upper = RANGES[kind]
    whole = math.trunc(value)
    if not lower <= whole <= upper:
        text = f"{value:.12g}"
        raise context.alarm(20847, block, name=shown, value=text, lower=lower, upper=upper)
    return float(whole)


def _declare(context: Context, block: Block, declared: Declare) -> Iterator[canon.Command]:
    """Make the variable anew, in the store of this call; V.S keeps the value it has."""
    name = declared.target.name
    if name.startswith("V.E.") or name in (PARAMETER, *OF_CYCLES):
        raise context.alarm(900121, block, name=name)
    sizes = _sizes(context, block, declared)
    values = [context.any_value(block, value) for value in declared.values]
    places = list(itertools.product(*(range(size) for size in sizes)))
    if len(values) > len(places):
        raise context.alarm(
            900124, block, name=spelled(name, sizes), given=len(values), places=len(places)
        )
    stores = _stores(context, name)
    if name.startswith("V.S.") and name in stores[0] and stores[0][name].sizes == sizes:
        return
    kind = declared.kind
    first: Value = "" if kind == STRING else 0.0
    cell = stores[0][name] = Cell(kind, sizes, dict.fromkeys(places, first))
    for place, value in zip(places, values, strict=False):
        cell.values[place] = _fitting(context, block, spelled(name, place), kind, value)
    yield from ()


def _sizes(context: Context, block: Block, declared: Declare) -> tuple[int, ...]:
    """Return the size of each dimension; raises Alarm 900123 for one that no array can have."""
    given = [context.value(block, size) for size in declared.target.indices]
    sizes = tuple(whole_index(size) or 0 for size in given)
    if not all(sizes) or math.prod(sizes) > ELEMENTS_MAX:
        shown = spelled(declared.target.name, tuple(f"{size:.10g}" for size in given))
        raise context.alarm(900123, block, name=shown, maximum=ELEMENTS_MAX)
    return sizes


def _assign(context: Context, block: Block, assign: Assign) -> Iterator[canon.Command]:
    value = context.any_value(block, assign.value)
    yield from context.write(block, assign.target, value)


def _reader(stem: str) -> Reader:
    def reader(context: Context, block: Block, rest: str, *indices: int) -> Value:
        return _read(context, block, f"{stem}.{rest}" if rest else stem, indices)

    return reader


def _writer(stem: str) -> Writer:
    def writer(
        context: Context, block: Block, rest: str, value: Value, *indices: int
    ) -> Iterator[canon.Command]:
        store(context, block, f"{stem}.{rest}" if rest else stem, value, indices)
        return iter(())

    return writer


def _bracket(context: Context, block: Block, statement: Command) -> None:
    """#VAR and #ENDVAR: what is between them are statements of their own."""


_STEMS = ("V.P", "V.L", "V.S", PARAMETER, *OF_CYCLES)
TOPIC = Topic(
    statements={Assign: _assign, Declare: _declare},
    commands={"VAR": silent(_bracket), "ENDVAR": silent(_bracket)},
    readers={stem: _reader(stem) for stem in _STEMS},
    writers={stem: _writer(stem) for stem in _STEMS},
)


def check(main: Unit) -> None:
    """Refuse names that no block of the program and its subprograms can have made.

    V.S may come from an earlier program of the session: only the run shows whether it does.
    Raises UserError with the nearest names.
    """
    units = reachable(main)
    parts = [
        (unit, part)
        for unit in units
        for routine in (unit.main, *unit.local.values())
        for part in routine.blocks
    ]
    for unit, part in parts:
        if isinstance(part.statement, For):
            _check_counter(unit, part.block, part.statement.variable.name)
    statements = [part.statement for _, part in parts if part.statement is not None]
    made = {variable.name for each in statements for variable in written_by(each)}
    declared = {each.target.name for each in statements if isinstance(each, Declare)}
    for unit in units:
        for name, line, column in unit.program.variables:
            if name.startswith(("V.P.", "V.L.")):
                _check_name(unit, name, (line, column), made, declared)


def _check_counter(unit: Unit, block: Block, name: str) -> None:
    """Refuse a counter that the PLC side keeps: what is written is there only later."""
    if name.startswith("V.E."):
        at = max(block.text.upper().find(name), 0)
        place = (block.line, block.column + at)
        _refuse(unit, place, "$FOR cannot count in a variable of the PLC side", name, "P or V.P")


def _check_name(
    unit: Unit, name: str, place: tuple[int, int], made: set[str], declared: set[str]
) -> None:
    stem = name.partition("[")[0]
    arrays = sorted(other for other in declared if other.partition("[")[0] == stem)
    if name in declared or (name in made and not arrays and "[" not in name):
        return
    if arrays:
        _refuse(unit, place, "variable is an array of other dimensions (ID 21216)", name, arrays)
    if name in made:
        _refuse(unit, place, "array is not declared", name, f"#VAR with {name} and its sizes")
    close = nearest(name, made)
    _refuse(unit, place, "variable is read and never written", name, close or None)


def _refuse(
    unit: Unit, place: tuple[int, int], message: str, name: str, allowed: object
) -> NoReturn:
    line, column = place
    raise UserError(
        message,
        file=unit.program.file,
        line=line,
        column=column,
        value=name,
        allowed=allowed,  # type: ignore[arg-type]
    )
