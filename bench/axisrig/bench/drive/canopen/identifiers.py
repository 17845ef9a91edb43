"""Identifiers in COB-ID entries: what the bits mean and which identifiers are taken.

Source: CiA 301, structures of the COB-ID entries and table of restricted CAN-IDs.
"""

from typing import Final

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort

NOT_VALID: Final = 1 << 31
BIT_30: Final = 1 << 30
"""In a TPDO: no remote request. In 1005: the node produces the SYNC."""
ID_MASK: Final = 0x7FF
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
_NOT_OF_11_BITS: Final = 0x3FFF_F800  # bit 29 and the identifier bits after the first 11


def check_identifier(value: int) -> None:
    """Refuse an identifier that is longer than 11 bits or restricted; raises SdoAbortedError."""
    can_id = value & ID_MASK
    if value & _NOT_OF_11_BITS or any(can_id in taken for taken in RESTRICTED):
        abort(AbortCode.INVALID_VALUE)


def check_cob_id(value: int, present: int) -> None:
    """Refuse a new COB-ID entry: a valid one keeps its identifier; raises SdoAbortedError."""
    if value & NOT_VALID:
        return
    if not present & NOT_VALID and (value ^ present) & ID_MASK:
        abort(AbortCode.INVALID_VALUE)
    check_identifier(value)
