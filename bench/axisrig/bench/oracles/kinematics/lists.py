"""Parameters of kinematics, read from what the lists of a channel and a program say.

Source: P-CHAN-00262, 00263, 00285 to 00293, 00446 to 00458, 00829 and docs/kinematics.md. Lengths
become mm, angles degrees.
"""

from collections.abc import Mapping
from dataclasses import dataclass

Written = Mapping[str, object]
"""Parameter -> value, only of those that a list or a plan has written."""
Program = Mapping[tuple[int, ...], float]
"""V.G.KIN_STEP[].ID[].PARAM[] by its three indices."""

PER_UNIT = 1e4
SETS = 100
LINEAR_TYPE = 1


@dataclass(frozen=True)
class Lists:
    """All that is written; `of` finds the set of one kinematic."""

    written: Written
    program: Program

    def of(self, step: int, kinematic: int | str) -> "Kinematics":
        """Find a set by its ID or name."""
        for prefix in self._prefixes(step):
            kind = int(self._number(f"{prefix}type"))
            number = int(self._number(f"{prefix}id")) or kind
            if kinematic in (number, str(number), self.written.get(f"{prefix}name")):
                return Kinematics(self, step, number, kind or number, prefix)
        number = int(kinematic)
        return Kinematics(self, step, number, number, f"kinematik[{number}].")

    def _prefixes(self, step: int) -> list[str]:
        found = []
        for number in range(SETS):
            names = [f"kin_step[{step}].trafo[{number}]."]
            if step == 0:
                names.append(f"trafo[{number}].")
            found += [n for n in names if any(path.startswith(n) for path in self.written)]
        return found

    def _number(self, path: str) -> float:
        return float(str(self.written.get(path, 0)))


@dataclass(frozen=True)
class Kinematics:
    """One set of parameters; prefix: how its paths begin."""

    lists: Lists
    step: int
    id: int
    type: int
    prefix: str

    def number(self, name: str) -> float:
        """Return a number as it is written, 0 where it is not."""
        return float(str(self.lists.written.get(self.prefix + name, 0)))

    def words(self, name: str) -> list[str]:
        """Return the words of an array up to the first blank."""
        found: list[str] = []
        while word := str(self.lists.written.get(f"{self.prefix}{name}[{len(found)}]", "")):
            found.append(word)
        return found

    def hd(self, number: int) -> float:
        """Return HD1, HD2, ... in mm or degrees: of the program, else of the list."""
        written = self.lists.program.get((self.step, self.id, number - 1))
        value = self.number(f"param[{number - 1}]") if written is None else written
        return value / PER_UNIT

    def vector(self, name: str, count: int = 3) -> list[float]:
        """Return the numbers of an array as they are written."""
        return [self.number(f"{name}[{k}]") for k in range(count)]

    def lengths(self, name: str, count: int = 3) -> list[float]:
        """Return an array in mm or degrees."""
        return [value / PER_UNIT for value in self.vector(name, count)]

    def axes(self) -> list[tuple[bool, list[float], list[float]]]:
        """Return whether rotary, direction and point in mm of each axis of kinematic 91."""
        return [
            (
                self.number(f"axis[{k}].type") != LINEAR_TYPE,
                self.vector(f"axis[{k}].orientation"),
                self.lengths(f"axis[{k}].point"),
            )
            for k in range(int(self.number("number_of_axes")))
        ]

    def order(self) -> list[int]:
        """Return the places of the axes of kinematic 91 from the machine base on."""
        count = int(self.number("number_of_axes"))
        places = [int(value) for value in self.vector("chain", count)]
        return places if len(set(places)) == count else list(range(count))
