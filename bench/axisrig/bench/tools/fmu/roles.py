"""What an FMU could be in a rig: by the names of its variables, or with a map."""

from collections.abc import Iterator, Sequence

from fmpy.model_description import ModelVariable

from axisrig.bench.tools.fmu.findings import Finding, ok, warn
from axisrig.kernel.cosim.fmi.fmu import FmuSlave
from axisrig.kernel.cosim.fmi.role_table import KINDS, Role, roles_of
from axisrig.kernel.cosim.fmi.roles import (
    Source,
    bind,
    coordinates_of,
    map_roles,
)
from axisrig.kernel.cosim.fmi.variable_index import of_causality
from axisrig.kernel.errors import UserError

_SHOWN_MAX = 3
# What the map must say beside the name of a variable, the plainest first
_MARKS = ("", " (lead_mm)", " (threshold)", " (unit)")


def role_findings(slave: FmuSlave) -> Iterator[Finding]:
    """Say for every kind of plant whether the FMU could be one, and what it would do without."""
    fitting, possible = [], []
    for kind in KINDS:
        coordinates = coordinates_of(slave, kind)
        try:
            found = map_roles(slave, kind, {}, coordinates)
        except UserError:
            possible += _with_map(slave, kind, coordinates or ["x"])
            continue
        reads = f" that reads {', '.join(coordinates)}" if coordinates else ""
        fitting.append(ok("roles", f"kind {kind}{reads}: has all it needs by its own names"))
        fitting += [warn("roles", f"{kind}: {note}") for note in found.notes]
    yield from fitting or possible
    if not fitting and not possible:
        yield ok("roles", "nothing in it can be an axis or a sensor of a rig")


def _with_map(slave: FmuSlave, kind: str, coordinates: Sequence[str]) -> list[Finding]:
    """Say which variables could fill the roles that a kind needs; nothing when one lacks."""
    offers = {
        name: _candidates(slave, name, role)
        for name, role in roles_of(kind, coordinates).items()
        if role.need == "required" or (role.need != "optional" and role.group == "plain")
    }
    if not all(offers.values()):
        return []
    text = "; ".join(f"{name} = {_some(found)}" for name, found in offers.items())
    return [ok("roles", f"kind {kind} with a map (docs/rigs.md): {text}")]


def _candidates(slave: FmuSlave, name: str, role: Role) -> list[str]:
    """Return the variables that fit a role, with what the map must say about each."""
    found: dict[str, list[str]] = {}
    for variable in of_causality(slave.description, role.causality):
        for mark, source in _attempts(variable, role):
            try:
                bind(slave, name, role, source)
            except UserError:
                continue
            found.setdefault(mark, []).append(f"{variable.name}{mark}")
            break
    return next((found[mark] for mark in _MARKS if mark in found), [])


def _attempts(variable: ModelVariable, role: Role) -> list[tuple[str, Source]]:
    """Ways to say in a map that a variable plays a role, the plainest first."""
    is_level = variable.type == "Boolean"
    if role.type == "flag":
        return [("" if is_level else " (threshold)", Source(variable.name))]
    if is_level:
        return []
    return [
        ("", Source(variable.name)),
        (" (lead_mm)", Source(variable.name, lead_m=1.0)),
        (" (unit)", Source(variable.name, role.unit or None)),
    ]


def _some(names: Sequence[str]) -> str:
    more = f" or {len(names) - _SHOWN_MAX} more" if len(names) > _SHOWN_MAX else ""
    return " or ".join(names[:_SHOWN_MAX]) + more
