"""Identifiers of CANopen: `identifiers.csv`, the pre-defined connection set, is their one home.

Source: CiA 301 (pre-defined connection set, structures of the COB-ID entries, restricted CAN-IDs),
CiA 305 (LSS).
"""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Final


@dataclass(frozen=True)
class Service:
    """One row of `identifiers.csv`: identifiers `first` to `last`; node_base: COB-ID of node 0."""

    name: str
    first: int
    last: int
    node_base: int | None


@cache
def services() -> tuple[Service, ...]:
    """Read `identifiers.csv`."""
    text = resources.files(__package__).joinpath("identifiers.csv").read_text(encoding="utf-8")
    return tuple(
        Service(
            row["service"],
            int(row["first"], 16),
            int(row["last"], 16),
            int(row["node_base"], 16) if row["node_base"] else None,
        )
        for row in csv.DictReader(text.splitlines())
    )


@cache
def service_of(can_id: int) -> Service | None:
    """Return the service of an identifier of 11 bits, None for one outside the set."""
    return next((s for s in services() if s.first <= can_id <= s.last), None)


def _base(name: str) -> int:
    found = next(service for service in services() if service.name == name)
    return found.first if found.node_base is None else found.node_base


NMT_ID: Final = _base("NMT")
SYNC_ID: Final = _base("SYNC")
EMERGENCY_BASE: Final = _base("EMCY")
SDO_ANSWER_BASE: Final = _base("SDO answer")
SDO_REQUEST_BASE: Final = _base("SDO request")
ERROR_CONTROL_BASE: Final = _base("heartbeat")
LSS_ANSWER_ID: Final = _base("LSS answer")
LSS_REQUEST_ID: Final = _base("LSS request")
PDO_BASE: Final[Mapping[str, int]] = {
    service.name: service.node_base
    for service in services()
    if service.node_base is not None and "PDO" in service.name
}
"""By the name of the PDO: COB-ID = base + node id."""

MAPPING_OF_PDO: Final = 0x200
"""From the communication parameter of a PDO (1400, 1800) to its mapping (1600, 1A00)."""

ID_MASK: Final = 0x7FF
NOT_VALID: Final = 1 << 31
BIT_30: Final = 1 << 30
"""In a TPDO: no remote request. In 1005: the node produces the SYNC."""
RESTRICTED: Final = (
    range(0x001),  # NMT
    range(0x001, 0x080),
    range(0x101, 0x181),
    range(0x581, 0x600),  # default SDO
    range(0x601, 0x680),  # default SDO
    range(0x6E0, 0x700),
    range(0x701, 0x780),  # NMT error control
    range(0x780, 0x800),
)
"""Identifiers that no COB-ID entry may take."""
