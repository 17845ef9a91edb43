"""What an FMU could be in a rig: by the names of its variables, or with a map."""

from collections.abc import Iterator, Mapping, Sequence

from bench.fmu.findings import Finding, ok, warn
from kernel.cosim.fmu import FmuSlave
from kernel.cosim.roles import KINDS, Role, Source, bind, coordinates_of, map_roles, roles_of
from kernel.errors import UserError

_SHOWN_MAX = 3
_NO_UNIT = " (no unit)"


def role_findings(slave: FmuSlave) -> Iterator[Finding]:
    """Tell for every kind of plant whether the FMU could be one, and what it would do without."""
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
    return [ok("roles", f"kind {kind} with a map (docs/rigs.md): {text}"), *_unit_hint(offers)]


def _unit_hint(offers: Mapping[str, Sequence[str]]) -> list[Finding]:
    if not any(text.endswith(_NO_UNIT) for found in offers.values() for text in found):
        return []
    return [warn("roles", "some of these have no unit", "say it in the map")]


def _candidates(slave: FmuSlave, name: str, role: Role) -> list[str]:
    """Return the inputs or outputs whose type and unit fit a role."""
    found = []
    for variable in slave.description.modelVariables:
        if variable.causality not in ("input", "output"):
            continue
        for unit, mark in ((None, ""), (role.unit or None, _NO_UNIT)):
            try:
                bind(slave, name, role, Source(variable.name, unit))
            except UserError:
                continue
            found.append(f"{variable.name}{mark}")
            break
    return found


def _some(names: Sequence[str]) -> str:
    more = f" or {len(names) - _SHOWN_MAX} more" if len(names) > _SHOWN_MAX else ""
    return " or ".join(names[:_SHOWN_MAX]) + more
