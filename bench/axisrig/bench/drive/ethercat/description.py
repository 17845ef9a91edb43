"""What a drive says of itself before anybody speaks to it: SII and ESI are made of it."""

from dataclasses import dataclass, field, replace
from typing import Final

from axisrig.bench.drive.cia402.dictionary.mapping import parts_of
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.ethercat.objects import (
    RX_ASSIGNMENT,
    RXPDOS,
    TX_ASSIGNMENT,
    TXPDOS,
    default_entries,
    ethercat_table,
    rows,
    type_of,
)
from axisrig.kernel.profiles.ethercat.layouts import (
    SM_MAILBOX,
    SM_MASTER_WRITES,
    SM_WATCHDOG,
)

MAILBOX_BYTES: Final = 128
_MAILBOX_START: Final = 0x1000
_OUTPUT_START: Final = 0x1800
_INPUT_START: Final = 0x1C00
_INTERRUPT: Final = 0x20  # at the slave's processor
ASSIGN_ACTIVATE: Final = 0x0300
CHANGES_OF_PDOS: Final = ("PdoAssign", "PdoConfig")


@dataclass(frozen=True)
class Entry:
    """An entry of a PDO. kind: number of its data type."""

    index: int
    sub: int
    bits: int
    kind: int
    name: str


@dataclass(frozen=True)
class Pdo:
    """A PDO as it is at power on. manager: of which SyncManager it is, None = not assigned."""

    index: int
    name: str
    manager: int | None
    entries: tuple[Entry, ...]

    @property
    def size(self) -> int:
        """Its length in bytes."""
        return sum(entry.bits for entry in self.entries) // 8


@dataclass(frozen=True)
class Manager:
    """A SyncManager as it has to be. kind: 1, 2 mailbox out and in; 3 outputs; 4 inputs."""

    start: int
    length: int
    control: int
    kind: int


@dataclass(frozen=True)
class Description:
    """One drive as EEPROM and ESI file describe it.

    coe: what its CoE can, the words of an ESI. is_sercos: its mailbox speaks SoE and not CoE.
    """

    serial: int
    managers: tuple[Manager, ...]
    rxpdos: tuple[Pdo, ...]
    txpdos: tuple[Pdo, ...]
    vendor: int = 0
    product: int = 402
    revision: int = 0x0001_0000
    alias: int = 0
    vendor_name: str = "axisrig"
    group: str = "axisrig drives"
    order: str = "DS402"
    name: str = "axisrig DS402 drive"
    fmmus: tuple[int, ...] = field(default=(1, 2, 3))
    is_sercos: bool = False
    coe: tuple[str, ...] = ("SdoInfo", *CHANGES_OF_PDOS, "PdoUpload", "CompleteAccess")


def describe(
    profile: DriveProfile, serial: int = 0, mailbox_bytes: int = MAILBOX_BYTES
) -> Description:
    """Describe a drive with this profile. mailbox_bytes: of each mailbox, 32 to 1024."""
    rxpdos = _pdos(RXPDOS, RX_ASSIGNMENT, 2, profile)
    txpdos = _pdos(TXPDOS, TX_ASSIGNMENT, 3, profile)
    managers = managers_of(mailbox_bytes, _assigned(rxpdos), _assigned(txpdos))
    usual = Description(serial, managers, rxpdos, txpdos)
    if not profile.fixed_pdos:
        return usual
    return replace(usual, coe=tuple(word for word in usual.coe if word not in CHANGES_OF_PDOS))


def managers_of(mailbox_bytes: int, outputs: int, inputs: int) -> tuple[Manager, ...]:
    """Return the SyncManagers of a drive with so many bytes of each."""
    return (
        Manager(_MAILBOX_START, mailbox_bytes, _INTERRUPT | SM_MASTER_WRITES | SM_MAILBOX, 1),
        Manager(_MAILBOX_START + mailbox_bytes, mailbox_bytes, _INTERRUPT | SM_MAILBOX, 2),
        Manager(_OUTPUT_START, outputs, SM_WATCHDOG | _INTERRUPT | SM_MASTER_WRITES, 3),
        Manager(_INPUT_START, inputs, _INTERRUPT, 4),
    )


def _assigned(pdos: tuple[Pdo, ...]) -> int:
    return sum(pdo.size for pdo in pdos if pdo.manager is not None)


def _pdos(
    indices: tuple[int, ...], assignment: int, manager: int, profile: DriveProfile
) -> tuple[Pdo, ...]:
    defaults = ethercat_table(profile).defaults(0)
    count = defaults[assignment, 0]
    assert isinstance(count, int)
    assigned = [defaults[assignment, sub] for sub in range(1, count + 1)]
    names = {row.index: row.name for row in rows() if row.sub is None}
    return tuple(
        Pdo(
            index,
            names[index].removesuffix(" mapping"),
            manager if index in assigned else None,
            tuple(_entry(entry, profile) for entry in default_entries(index, profile)),
        )
        for index in indices
    )


def _entry(entry: int, profile: DriveProfile) -> Entry:
    index, sub, bits = parts_of(entry)
    row = ethercat_table(profile).rows[index, sub]
    return Entry(index, sub, bits, type_of(row, profile).code, row.name)
