"""Abort codes of the SDO protocol (CiA 301, clause SDO abort transfer protocol)."""

from enum import IntEnum
from typing import NoReturn

from canopen.sdo.exceptions import SdoAbortedError


class AbortCode(IntEnum):
    """The codes that the drive sends, and when."""

    TOGGLE = 0x05030000
    """The toggle bit of a segment has not alternated."""
    TIMED_OUT = 0x05040000
    """The client has not gone on with its transfer in time."""
    COMMAND = 0x05040001
    """Command specifier unknown, or not of the transfer that is under way."""
    BLOCK_SIZE = 0x05040002
    """Block size 0 or above 127."""
    SEQUENCE_NUMBER = 0x05040003
    """A block acknowledges a segment that has not been sent."""
    CRC = 0x05040004
    """The check sum of a block transfer is wrong."""
    UNSUPPORTED_ACCESS = 0x06010000
    """A mapping is changed while its PDO is valid, or an entry while their number is not 0."""
    WRITE_ONLY = 0x06010001
    """A write-only object is read."""
    COMPLETE_ACCESS = 0x06010004
    """The object cannot be accessed as a whole."""
    READ_ONLY = 0x06010002
    """A read-only object is written."""
    NO_OBJECT = 0x06020000
    """The object does not exist."""
    NOT_MAPPABLE = 0x06040041
    """The object cannot be mapped to this PDO, or not with this length."""
    PDO_TOO_LONG = 0x06040042
    """The mapped objects are longer than a PDO."""
    INCOMPATIBLE = 0x06040043
    """The value does not go together with another parameter."""
    LENGTH = 0x06070010
    """The data is not as long as announced."""
    TOO_LONG = 0x06070012
    """More data than the object has."""
    TOO_SHORT = 0x06070013
    """Less data than the object has."""
    NO_SUB_INDEX = 0x06090011
    """The sub-index does not exist."""
    INVALID_VALUE = 0x06090030
    """The value is not one of those allowed."""
    TOO_HIGH = 0x06090031
    """The value is above its limit."""
    TOO_LOW = 0x06090032
    """The value is below its limit."""
    NOT_STORED = 0x08000020
    """The signature of a store or restore command is wrong."""
    DEVICE_STATE = 0x08000022
    """Not in the present state of the device."""
    NO_DATA = 0x08000024
    """There is no value to read."""


def abort(code: AbortCode) -> NoReturn:
    """Refuse an access; raises SdoAbortedError."""
    raise SdoAbortedError(int(code))
