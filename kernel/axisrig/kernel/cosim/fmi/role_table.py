"""The table of roles (`roles.csv`): what the bench needs of a plant."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources


@dataclass(frozen=True)
class Role:
    """One row of `roles.csv`; `<g>` in a name means a coordinate that the rig wires.

    group: roles that only make sense together. need: `required`, `optional`, or a word that
    several groups share, one of which must be complete. without: what happens then.
    """

    role: str
    kind: str
    group: str
    causality: str
    type: str
    unit: str
    need: str
    without: str


@cache
def role_table() -> tuple[Role, ...]:
    """Read `roles.csv`."""
    text = resources.files(__package__).joinpath("roles.csv").read_text(encoding="utf-8")
    return tuple(Role(**row) for row in csv.DictReader(text.splitlines()))


def roles_of(kind: str, coordinates: Sequence[str]) -> dict[str, Role]:
    """Return the roles of a kind by name, `<g>` replaced by each coordinate."""
    return dict(_roles_of(kind, tuple(coordinates)))


@cache
def _roles_of(kind: str, coordinates: tuple[str, ...]) -> Mapping[str, Role]:
    found: dict[str, Role] = {}
    for role in role_table():
        if role.kind == kind:
            names = [role.role.replace("<g>", g) for g in coordinates]
            found |= dict.fromkeys(names if "<g>" in role.role else [role.role], role)
    return found


@cache
def group_of(kind: str, coordinates: tuple[str, ...], group: str) -> tuple[str, ...]:
    """Return the names of the roles of a group, in the order of the table."""
    return tuple(n for n, role in _roles_of(kind, coordinates).items() if role.group == group)


KINDS = tuple(dict.fromkeys(role.kind for role in role_table()))
