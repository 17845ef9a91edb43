"""Which identifiers a COB-ID entry takes.

Source: CiA 301, structures of the COB-ID entries and table of restricted CAN-IDs.
"""

from typing import Final

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.kernel.profiles.canopen.identifiers import ID_MASK, NOT_VALID, RESTRICTED

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
