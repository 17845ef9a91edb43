"""What the bench needs of a plant, and which variables of an FMU give it (`roles.csv`).

A role is a meaning with an SI unit. Variables that have the name of a role in the right unit are
taken by themselves; others are mapped by the rig. What is missing and can be done without is always
reported in `notes`.
"""

import ctypes
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn, Protocol

from fmpy.model_description import ModelVariable

from axisrig.kernel.cosim.fmi.library import array_type
from axisrig.kernel.cosim.fmi.role_table import KINDS, Role, group_of, role_table, roles_of
from axisrig.kernel.cosim.fmi.slave import Exchange, FmuSlave
from axisrig.kernel.cosim.fmi.units import Unit, known_units, unit_of
from axisrig.kernel.errors import UserError, nearest

FLAG_THRESHOLD = 0.5
_TORQUE = known_units()["N.m"].exponents
# What a variable may be by the FMU, for a causality of roles.csv
_MAY_BE = {
    "input": ("input",),
    "output": ("output", "local"),  # never an input: the bench would read back what it wrote
    "any": ("output", "local", "calculatedParameter", "parameter", "input"),
}

# Groups whose names an FMU may use for something else; it need not take part in them
_MAY_BE_ANOTHER = ("control", "force_limits", "force_limit", "force", "stop_force", "stop_face")


class Values(Protocol):
    """A fixed list of values that are exchanged together, in SI; `Exchange` is one."""

    values: Any

    def read(self) -> None:
        """Fill `values` from the FMU."""
        ...

    def write(self) -> None:
        """Hand `values` to the FMU."""
        ...


@dataclass(frozen=True)
class Source:
    """Where a role comes from: a variable, and what its number means.

    unit: None = as the FMU says. sign: -1 turns the direction round, or inverts a level.
    threshold: a number above it is the level true. lead_m: travel per revolution, for a rotation
    that represents a travel (and a torque for a force along it).
    """

    variable: str
    unit: str | None = None
    sign: int = 1
    threshold: float = FLAG_THRESHOLD
    lead_m: float | None = None


@dataclass(frozen=True)
class Bound:
    """A role bound to a variable: SI = factor * value + offset; a flag is value > threshold."""

    variable: str
    factor: float = 1.0
    offset: float = 0.0
    threshold: float | None = None

    @property
    def is_plain(self) -> bool:
        """Whether the FMU's own value is the value of the role."""
        return self.factor == 1.0 and self.offset == 0.0 and self.threshold is None

    def to_si(self, value: float) -> float:
        """Give the role's value for one of the FMU."""
        if self.threshold is not None:
            return float((value > self.threshold) is (self.factor > 0))
        return self.factor * value + self.offset

    def from_si(self, value: float) -> float:
        """Give the FMU's value for one of the role."""
        if self.threshold is not None:
            return float(bool(value) is (self.factor > 0))
        return (value - self.offset) / self.factor


def bind(slave: FmuSlave, name: str, role: Role, source: Source) -> Bound:
    """Bind a role to a variable. Raises UserError when the variable or its unit does not fit."""
    variable = slave.variable(source.variable)
    if variable.causality not in _MAY_BE[role.causality]:
        raise UserError(
            f"{name} needs an {role.causality}; {variable.name} has the causality "
            f"{variable.causality}",
            value=variable.name,
            allowed=nearest(variable.name, slave.names(role.causality))
            or slave.names(role.causality)
            or "none",
        )
    if variable.type not in slave.TYPES or variable.shape:
        raise UserError(f"{name} needs one number or level", value=f"{variable.type}")
    if role.type == "flag":
        is_level = variable.type == "Boolean" and source.sign > 0
        return Bound(variable.name, source.sign, 0.0, None if is_level else source.threshold)
    if role.type == "count":
        return Bound(variable.name)
    factor, offset = _conversion(slave, name, role, source, variable)
    return Bound(variable.name, factor, offset)


def _conversion(
    slave: FmuSlave, name: str, role: Role, source: Source, variable: ModelVariable
) -> tuple[float, float]:
    unit = unit_of(slave.description, variable, source.unit)
    needed = known_units()[role.unit]
    if unit is None:
        raise UserError(
            f"{variable.name} has no unit in the FMU, {name} needs one of {role.unit}",
            value=variable.name,
            hint=f'say it: {name} = {{ variable = "{variable.name}", unit = "{role.unit}" }}',
        )
    scale = float(source.sign)
    if source.lead_m is not None and unit.exponents == _TORQUE == _as_torque(needed.exponents):
        unit = Unit(unit.name, needed.exponents, unit.factor)
        scale *= 2 * math.pi / source.lead_m
    elif source.lead_m is not None:
        unit = _as_travel(unit, variable)
        scale *= source.lead_m / (2 * math.pi)
    if unit.exponents != needed.exponents:
        is_rotation = _as_travel_exponents(unit) == needed.exponents
        raise UserError(
            f"{variable.name} is in {unit.name} ({_in_bases(unit)}), {name} needs a unit of "
            f"{role.unit}",
            value=unit.name,
            hint="a rotation needs lead_mm, the travel per revolution" if is_rotation else None,
        )
    return scale * unit.factor, scale * unit.offset


def _as_torque(exponents: tuple[int, ...]) -> tuple[int, ...]:
    kg, m, *rest = exponents
    return (kg, m + 1, *rest)


def _as_travel_exponents(unit: Unit) -> tuple[int, ...]:
    kg, m, *middle, rad = unit.exponents
    return (kg, m + rad, *middle, 0)


def _as_travel(unit: Unit, variable: ModelVariable) -> Unit:
    if unit.exponents[-1] != 1:
        raise UserError(
            f"{variable.name} is in {unit.name}; lead_mm is for rotations", value=unit.name
        )
    return Unit(unit.name, _as_travel_exponents(unit), unit.factor, unit.offset)


def _in_bases(unit: Unit) -> str:
    bases = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
    parts = [
        base + (str(exponent) if exponent != 1 else "")
        for base, exponent in zip(bases, unit.exponents, strict=True)
        if exponent
    ]
    return ".".join(parts) or "1"


class Roles:
    """The roles that an FMU fills as an axis or a sensor.

    kind: of `roles.csv`. coordinates: those that the rig wires to a sensor. bound: role -> variable
    with its conversion. notes: what is missing and what happens without it.
    """

    def __init__(
        self,
        slave: FmuSlave,
        kind: str,
        bound: Mapping[str, Bound],
        coordinates: Sequence[str] = (),
    ) -> None:
        self.slave, self.kind, self.coordinates = slave, kind, tuple(coordinates)
        self.bound = dict(bound)
        self.notes: list[str] = []
        self._check()

    def has(self, *roles: str) -> bool:
        """Return whether all these roles are there."""
        return all(role in self.bound for role in roles)

    def has_group(self, group: str) -> bool:
        """Return whether all roles of a group are there."""
        return self.has(*self._group(group))

    def _group(self, group: str) -> tuple[str, ...]:
        return group_of(self.kind, self.coordinates, group)

    def _check(self) -> None:
        """Refuse what is missing and needed; note what is missing and not."""
        needs: dict[str, list[str]] = {}
        for role in roles_of(self.kind, self.coordinates).values():
            groups = needs.setdefault(role.need, [])
            if role.group not in groups:
                groups.append(role.group)
        for need, groups in needs.items():
            lacking = [group for group in groups if not self.has_group(group)]
            is_choice = need not in ("required", "optional")
            if (lacking and need == "required") or (is_choice and lacking == groups):
                self._refuse(lacking, " or " if is_choice else " and ")
            for group in lacking:
                self._leave_out(group)

    def _refuse(self, groups: Sequence[str], between: str) -> NoReturn:
        missing = [
            ", ".join(name for name in self._group(group) if name not in self.bound)
            for group in groups
        ]
        raise UserError(
            f"{self.slave.path.name} lacks what a plant of the kind {self.kind} needs: "
            f"{between.join(missing)}",
            hint="map its variables to these roles, see docs/rigs.md",
        )

    def _leave_out(self, group: str) -> None:
        """Take out what is there of an incomplete group: half a group is none."""
        roles, names = roles_of(self.kind, self.coordinates), self._group(group)
        without = next((roles[name].without for name in names if roles[name].without), "")
        missing = [name for name in names if self.bound.pop(name, None) is None]
        if without:
            self.notes.append(f"no {', '.join(missing)}: {without}")

    def exchange(self, roles: Sequence[str]) -> Values:
        """Return the values of some roles, in SI, in their order."""
        bound = [self.bound[role] for role in roles]
        types = {str(self.slave.variable(b.variable).type) for b in bound}
        if len(types) == 1 and all(b.is_plain for b in bound) and types != {"Float32"}:
            return Exchange(self.slave, [b.variable for b in bound])
        return ConvertedExchange(self.slave, bound)

    def spare_inputs(self) -> list[str]:
        """Return the inputs that nothing is wired to; they keep their start values."""
        used = {bound.variable for bound in self.bound.values()}
        return [name for name in self.slave.names("input") if name not in used]


class ConvertedExchange:
    """Values of roles whose variables have other units or types: SI outside, the FMU's inside.

    values: doubles in the order of the roles.
    """

    def __init__(self, slave: FmuSlave, bound: Sequence[Bound]) -> None:
        self.values = array_type(ctypes.c_double, len(bound))()
        types: dict[str, list[int]] = {}
        for index, item in enumerate(bound):
            types.setdefault(str(slave.variable(item.variable).type), []).append(index)
        self._parts = [
            (
                Exchange(slave, [bound[i].variable for i in places]),
                [(i, bound[i].to_si, bound[i].from_si) for i in places],
                kind.startswith(("Float", "Real")),
            )
            for kind, places in types.items()
        ]

    def read(self) -> None:
        """Fill `values` from the FMU."""
        values = self.values
        for exchange, places, _ in self._parts:
            exchange.read()
            for value, (index, to_si, _) in zip(exchange.values[:], places, strict=True):
                values[index] = to_si(value)

    def write(self) -> None:
        """Hand `values` to the FMU."""
        values = self.values[:]
        for exchange, places, is_real in self._parts:
            raw = [from_si(values[index]) for index, _, from_si in places]
            exchange.values[:] = raw if is_real else [round(value) for value in raw]
            exchange.write()


Located = Callable[[UserError, str], UserError]


def _as_it_is(error: UserError, _role: str) -> UserError:
    return error


def refuse_unknown(
    kind: str,
    names: Iterable[str],
    coordinates: Sequence[str] = (),
    located: Located = _as_it_is,
) -> None:
    """Raise UserError for a name that is no role of a kind."""
    roles = roles_of(kind, coordinates)
    for name in names:
        if name not in roles:
            error = UserError(
                f"a plant of the kind {kind} has no such role",
                value=name,
                allowed=nearest(name, roles) or roles,
            )
            raise located(error, name)


def map_roles(
    slave: FmuSlave,
    kind: str,
    sources: Mapping[str, Source | None],
    coordinates: Sequence[str] = (),
    located: Located = _as_it_is,
) -> Roles:
    """Bind the variables of an FMU to the roles of a kind.

    sources: role -> variable; None leaves a role out. Variables that have the name of a role are
    taken for it. located: makes of an error, and the role it is about, one that names the place.
    Raises UserError for what does not fit.
    """
    roles = roles_of(kind, coordinates)
    refuse_unknown(kind, sources, coordinates, located)
    bound: dict[str, Bound] = {}
    namesakes: list[str] = []
    for name, role in roles.items():
        source = sources.get(name, Source(name))
        if source is None or (name not in sources and not _fits(slave, name, role)):
            continue
        try:
            bound[name] = bind(slave, name, role, source)
            _refuse_second_writer(bound, roles, name)
        except UserError as error:
            if name in sources or role.group not in _MAY_BE_ANOTHER:
                raise located(error, name) from error
            namesakes.append(f"{name} of the FMU is not taken: {error.message}")
    both = ("force_limit_negative", "force_limit_positive")
    if "force_limit" not in sources and all(name in bound for name in both):
        bound.pop("force_limit", None)  # an input that only `start` sets
    found = Roles(slave, kind, bound, coordinates)
    found.notes += namesakes
    return found


def _refuse_second_writer(bound: Mapping[str, Bound], roles: Mapping[str, Role], name: str) -> None:
    """Raise UserError when two roles would write one input: the later one would win unnoticed."""
    if roles[name].causality != "input":
        return
    variable = bound[name].variable
    writers = [r for r, b in bound.items() if b.variable == variable and r != name]
    for other in writers:
        if roles[other].causality == "input":
            raise UserError(
                f"{other} and {name} would write the same input",
                value=variable,
                hint="map each role to an input of its own, or one of them to false",
            )


def _fits(slave: FmuSlave, name: str, role: Role) -> bool:
    """Return whether a variable that has a role's name may be used for it."""
    if not slave.has(name):
        return False
    return slave.variable(name).causality in _MAY_BE[role.causality]


def guess_kind(slave: FmuSlave, sources: Mapping[str, Source | None]) -> str | None:
    """Return the kind of a plant by the mapped roles, else by its variables; None: unclear.

    A role that is left out is none of its kind.
    """
    names = {name for name, source in sources.items() if source is not None}
    mapped = [
        kind
        for kind in KINDS
        if names & roles_of(kind, coordinates_of(slave, kind, sources)).keys()
    ]
    if len(mapped) == 1:
        return mapped[0]
    found = []
    for kind in KINDS:
        coordinates = coordinates_of(slave, kind, sources)
        roles = roles_of(kind, coordinates)
        there = {
            name
            for name, role in roles.items()
            if sources.get(name) or (name not in sources and _fits(slave, name, role))
        }
        needs: dict[str, set[bool]] = {}
        groups = {(role.need, role.group) for role in roles.values() if role.need != "optional"}
        for need, group in groups:
            names = {name for name, role in roles.items() if role.group == group}
            needs.setdefault(need, set()).add(names <= there)
        required = needs.pop("required", {True})
        if required == {True} and all(True in choices for choices in needs.values()):
            found.append(kind)
    return found[0] if len(found) == 1 else None


def coordinates_of(
    slave: FmuSlave, kind: str, sources: Mapping[str, Source | None] = {}
) -> list[str]:
    """Return the coordinates that a sensor reads, by the names of its inputs and mapped roles.

    What is a role of an axis (`reference_end`) names no coordinate.
    """
    found: dict[str, None] = {}
    of_axes = roles_of("axis", ())
    names = [name for name in (*slave.names("input"), *sources) if name not in of_axes]
    for role in role_table():
        if role.kind == kind and role.need == "path" and role.role.startswith("<g>"):
            ending = role.role.removeprefix("<g>")
            for name in names:
                if name.endswith(ending) and not name.endswith(f"_rate{ending}"):
                    found[name.removesuffix(ending)] = None
    return list(found)
