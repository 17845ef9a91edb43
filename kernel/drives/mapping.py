"""The cyclic telegram of a drive: which objects its PDOs carry, and their codecs.

The table `pdo_map.csv` is what the kernel writes into the drive at start-up and what it packs
and unpacks afterwards, so that both cannot differ.
"""

import csv
import struct
from dataclasses import dataclass
from functools import cache
from importlib import resources

# Pre-defined connection set: CiA 301, COB-ID = base + node id
COB_ID_BASE = {
    "TPDO1": 0x180, "RPDO1": 0x200, "TPDO2": 0x280, "RPDO2": 0x300,
    "TPDO3": 0x380, "RPDO3": 0x400, "TPDO4": 0x480, "RPDO4": 0x500,
}  # fmt: skip
_FORMAT = {(8, False): "B", (8, True): "b", (16, False): "H", (16, True): "h",
           (32, False): "I", (32, True): "i"}  # fmt: skip
LATCH = "latch"


@dataclass(frozen=True)
class MappedObject:
    """One object of a PDO: index, sub-index, length in bits, field name of the link."""

    index: int
    sub: int
    bits: int
    signed: bool
    field: str

    @property
    def entry(self) -> int:
        """The mapping entry as CiA 301 writes it: index << 16 | sub << 8 | bits."""
        return self.index << 16 | self.sub << 8 | self.bits


@dataclass(frozen=True)
class Telegram:
    """One PDO: name, transmission type, inhibit time (100 us) and what it carries."""

    name: str
    transmission: int
    inhibit_100us: int
    objects: tuple[MappedObject, ...]

    @property
    def is_cyclic(self) -> bool:
        """Whether the PDO is sent or taken at every SYNC (CiA 301 transmission types 1 to 240)."""
        return 1 <= self.transmission <= 240

    @property
    def length(self) -> int:
        """Payload in bytes."""
        return sum(o.bits for o in self.objects) // 8

    @property
    def codec(self) -> struct.Struct:
        """The codec of the payload: little endian, no padding (CiA 301)."""
        return struct.Struct("<" + "".join(_FORMAT[o.bits, o.signed] for o in self.objects))

    def cob_id(self, node_id: int) -> int:
        """Return the COB-ID of the pre-defined connection set."""
        return COB_ID_BASE[self.name] + node_id


@cache
def telegrams(latch_object: int) -> dict[str, Telegram]:
    """Return the PDOs of a drive whose latch object in use is `latch_object` (0x60BA to 0x60BD)."""
    text = resources.files(__package__).joinpath("pdo_map.csv").read_text(encoding="utf-8")
    grouped: dict[str, list[dict[str, str]]] = {}
    for row in csv.DictReader(text.splitlines()):
        grouped.setdefault(row["pdo"], []).append(row)
    return {
        name: Telegram(
            name=name,
            transmission=int(rows[0]["transmission"]),
            inhibit_100us=int(rows[0]["inhibit_100us"]),
            objects=tuple(
                MappedObject(
                    index=latch_object if row["index"] == LATCH else int(row["index"], 16),
                    sub=int(row["sub"]),
                    bits=int(row["bits"]),
                    signed=row["signed"] == "yes",
                    field=row["field"],
                )
                for row in rows
            ),
        )
        for name, rows in grouped.items()
    }
