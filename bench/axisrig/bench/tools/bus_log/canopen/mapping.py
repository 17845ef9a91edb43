"""Which PDOs the frames of a log are: by what masters wrote in this log, else by the rig.

Source: CiA 301, PDO communication (14xx, 18xx) and mapping parameters (16xx, 1Axx).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from axisrig.bench.drive.cia402.dictionary.objects import variables
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.profiles.canopen.identifiers import MAPPING_OF_PDO, PDO_BASE

NOT_VALID: Final = 1 << 31
EXTENDED: Final = 1 << 29
STANDARD_MASK, EXTENDED_MASK = 0x7FF, 0x1FFF_FFFF
PDOS: Final = 512  # of each direction
MAPPED_MAX: Final = 64
_KINDS: Final = ((0x1400, "RPDO"), (0x1600, "RPDO"), (0x1800, "TPDO"), (0x1A00, "TPDO"))
Node = tuple[str, int]
"""Segment and node number."""


@dataclass(frozen=True)
class Pdo:
    """A PDO that a frame is: of which node, its name, what it carries; None = not known."""

    node: int
    name: str
    telegram: Telegram | None


class LoggedPdos:
    """The PDOs of a log by identifier; telegrams: those of the rig, by node and name."""

    def __init__(self, telegrams: Mapping[Node, Mapping[str, Telegram]]) -> None:
        self._rig = telegrams
        self._written: dict[Node, dict[tuple[int, int], int]] = {}
        self._identifiers: dict[tuple[Node, str], tuple[str, int]] = {}
        self._found: dict[tuple[str, int], dict[tuple[Node, str], Pdo]] = {}
        for node, named in telegrams.items():
            for name in named:
                self._update(node, name)

    def find(self, segment: str, can_id: int, is_extended: bool) -> Pdo | None:
        """Return the PDO that a frame is: of its producer, else of the first that receives it."""
        key = segment, can_id | (EXTENDED if is_extended else 0)
        found = [*self._found.get(key, {}).values()]
        sent = [pdo for pdo in found if pdo.name.startswith("T")]
        return next(iter(sent or found), None)

    def note(self, segment: str, node: int, index: int, sub: int, value: int) -> None:
        """Take what an object of a node has."""
        for base, kind in _KINDS:
            if base <= index < base + PDOS:
                self._written.setdefault((segment, node), {})[index, sub] = value
                self._update((segment, node), f"{kind}{index - base + 1}")

    def forget(self, segment: str, node: int) -> None:
        """Take a node that has started anew for what the rig says of it."""
        owner = segment, node
        names = {name for whose, name in self._identifiers if whose == owner}
        self._written.pop(owner, None)
        for name in names | {*self._rig.get(owner, ())}:
            self._update(owner, name)

    def _update(self, owner: Node, name: str) -> None:
        """Find identifier and mapping of one PDO again."""
        old = self._identifiers.pop((owner, name), None)
        if old is not None:
            self._found[old].pop((owner, name), None)
        segment, node = owner
        cob_id = self._cob_id(owner, name)
        if cob_id is None or cob_id & NOT_VALID:
            return
        mask = EXTENDED_MASK | EXTENDED if cob_id & EXTENDED else STANDARD_MASK
        key = segment, cob_id & mask
        self._identifiers[owner, name] = key
        pdo = Pdo(node, name, self._telegram(owner, name))
        self._found.setdefault(key, {})[owner, name] = pdo

    def _cob_id(self, owner: Node, name: str) -> int | None:
        """Return 14xx:1 or 18xx:1: as written, of the rig, of the pre-defined connection set."""
        written = self._written.get(owner, {})
        index = _communication(name)
        if (index, 1) in written:
            return written[index, 1]
        telegram = self._rig.get(owner, {}).get(name)
        if telegram is not None:
            return telegram.cob_id(owner[1])
        is_mapped = any(place[0] == index + MAPPING_OF_PDO for place in written)
        return PDO_BASE[name] + owner[1] if is_mapped and name in PDO_BASE else None

    def _telegram(self, owner: Node, name: str) -> Telegram | None:
        """Return what a PDO carries, None where the log does not show all of its mapping."""
        written = self._written.get(owner, {})
        mapping = _communication(name) + MAPPING_OF_PDO
        rig = self._rig.get(owner, {}).get(name)
        if not any(place[0] == mapping for place in written):
            return rig
        known = {sub: value for (index, sub), value in written.items() if index == mapping}
        entries = {n: o.entry for n, o in enumerate(rig.objects, 1)} if rig is not None else {}
        entries |= known
        count = known.get(0, len(rig.objects) if rig is not None else None)
        if count is None or count > MAPPED_MAX:
            return None
        places = range(1, count + 1)
        if not all(place in entries for place in places):
            return None
        signed = {o.entry: o.signed for o in rig.objects} if rig is not None else {}
        return Telegram(name, 1, 0, tuple(_object(entries[place], signed) for place in places))


def _communication(name: str) -> int:
    return (0x1400 if name.startswith("R") else 0x1800) + int(name[4:]) - 1


def _object(entry: int, signed: Mapping[int, bool]) -> MappedObject:
    index, sub, bits = entry >> 16, entry >> 8 & 0xFF, entry & 0xFF
    row = variables().get((index, sub))
    is_signed = row is not None and row.type == f"I{bits}"
    return MappedObject(index, sub, bits, signed.get(entry, is_signed), "")
