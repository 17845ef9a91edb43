"""What the lists of a channel say about kinematics, read once (`trafo[]` and others)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import ParameterSet, Value
from axisrig.kernel.parameters.table import indices_of

STEPS: Final = 2
Key = tuple[str, tuple[int, ...]]


@dataclass(frozen=True)
class Trafo:
    """A set of parameters of one kinematic: numbers as lists write them (0.1 um, 0.0001 deg).

    values: by the name inside the set and its indices, as in `("axis[].point[]", (1, 2))`.
    """

    id: int
    type: int
    name: str = ""
    values: Mapping[Key, Value] = field(default_factory=dict)

    def number(self, name: str, *indices: int) -> float:
        """Return a number, 0 where none is written."""
        return float(self.values.get((name, indices), 0))

    def word(self, name: str, *indices: int) -> str:
        """Return a word, blank where none is written."""
        return str(self.values.get((name, indices), ""))

    def has(self, name: str) -> bool:
        """Whether any element of a name is written."""
        return any(key[0] == name for key in self.values)


@dataclass(frozen=True)
class KinematicData:
    """The sets of parameters of each step by their ID, and what `#TRAFO ON` selects by itself."""

    steps: tuple[Mapping[int, Trafo], ...] = ({}, {})
    default_ids: tuple[int, ...] = ()

    @classmethod
    def read(cls, channel: ParameterSet) -> "KinematicData":
        """Read the parameters of a channel. Raises UserError for an ID that is there twice."""
        sets: dict[tuple[int, int], dict[Key, Value]] = {}
        older: dict[int, dict[Key, Value]] = {}
        places: dict[tuple[int, int], str] = {}
        for path, value in channel.items():
            indices = indices_of(path)
            if path.startswith("kin_step["):
                name = path.partition("].trafo[")[2].partition("].")[2]
                places.setdefault((indices[0], indices[1]), path)
                sets.setdefault((indices[0], indices[1]), {})[_key(name)] = value
            elif path.startswith("kinematik["):
                older.setdefault(indices[0], {})["param[]", indices[1:]] = value
        steps: tuple[dict[int, Trafo], ...] = tuple({} for _ in range(STEPS))
        for kinematic_id, values in older.items():
            for known in steps:  # older lists know no steps
                known[kinematic_id] = Trafo(kinematic_id, kinematic_id, "", values)
        seen: set[tuple[int, int]] = set()
        for (step, number), values in sorted(sets.items()):
            path = f"kin_step[{step}].trafo[{number}]"
            found = _trafo(channel, path, values)
            if (step, found.id) in seen:
                raise _twice(channel, places[step, number], found.id)
            seen.add((step, found.id))
            steps[step][found.id] = found
        return cls(steps, _default_ids(channel))


def _trafo(channel: ParameterSet, path: str, values: dict[Key, Value]) -> Trafo:
    kind = channel.integer(f"{path}.type")
    return Trafo(
        channel.integer(f"{path}.id") or kind,
        kind,
        channel.word(f"{path}.name"),
        values,
    )


def _key(name: str) -> Key:
    """Split `axis[1].point[2]` into `axis[].point[]` and its indices."""
    parts = name.replace("]", "[").split("[")
    return "[]".join(parts[::2]), tuple(map(int, parts[1::2]))


def _default_ids(channel: ParameterSet) -> tuple[int, ...]:
    first = channel.integer("default_id_of_kin_step[0]") or channel.integer("kinematik_id")
    second = channel.integer("default_id_of_kin_step[1]")
    return (first, second) if second else (first,) if first else ()


def _twice(channel: ParameterSet, path: str, kinematic_id: int) -> UserError:
    origin = channel.origin(path)
    message = f"kinematic {kinematic_id} has two sets of parameters in one step"
    hint = "give each set its own ID (trafo[].id) and say by .type what it is"
    if origin is None:
        return UserError(message, hint=hint)
    return origin.error(message, value=kinematic_id, hint=hint)
