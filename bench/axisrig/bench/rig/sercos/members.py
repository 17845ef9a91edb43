"""SERCOS axes of a rig: their tables and telegrams."""

from axisrig.bench.rig.sercos.keys import DriveTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.ethercat.settings import Pdo
from axisrig.kernel.drives.mapped import MappedObject
from axisrig.kernel.profiles.sercos.service import ident_number
from axisrig.kernel.profiles.sercos.words import (
    AT_LIST,
    CONTROL_WORD,
    MDT_LIST,
    STATUS_WORD,
    WORD_BITS,
    telegram_idents,
)


def drive_of(settings: Settings, name: str) -> DriveTable:
    """Return `[drive.D]` of a SERCOS axis."""
    table = settings.rig.drive[settings.rig.axis[name].drive]
    assert isinstance(table, DriveTable), name
    return table


def sercos_pdos(settings: Settings, name: str) -> tuple[Pdo, Pdo]:
    """Return the MDT and the AT of an axis: the word, then what the rig lists."""
    table = drive_of(settings, name)
    return (
        _telegram(MDT_LIST, CONTROL_WORD, "controlword", table.mdt),
        _telegram(AT_LIST, STATUS_WORD, "statusword", table.at),
    )


def _telegram(index: int, word: int, field: str, names: list[str]) -> Pdo:
    carried = [MappedObject(word, 0, WORD_BITS, False, field)]
    for name in names:
        row = telegram_idents().get(ident_number(name))
        if row is not None:  # others are refused by the checks
            carried.append(MappedObject(row.ident, 0, 8 * row.bytes, row.is_signed, row.field))
    return Pdo(index, tuple(carried))
