"""Layouts of EtherCAT frames, registers and mailboxes; all integers little-endian.

Sources: as `tables.py`. A frame is counted from its destination address on, without FCS.
"""

from enum import IntEnum
from struct import Struct
from typing import Final

ETHERTYPE: Final = 0x88A4
ETHERNET_HEADER: Final = Struct(">6s6sH")
"""Destination, source, ethertype; the only big-endian one."""
FRAME_HEADER: Final = Struct("<H")
"""Bits 0 to 10 length of all datagrams, 12 to 15 type."""
FRAME_TYPE_DATAGRAMS: Final = 1
FIRST_DATAGRAM: Final = ETHERNET_HEADER.size + FRAME_HEADER.size
DATAGRAM: Final = Struct("<BBHHHH")
"""Command, index, ADP, ADO (logical: the two halves of one address), length and flags, events."""
LENGTH_MASK: Final = 0x07FF
MORE: Final = 1 << 15
WORKING_COUNTER: Final = Struct("<H")
FRAME_MIN: Final = 60
FRAME_MAX: Final = 1514
DATAGRAM_DATA_MAX: Final = 1486

# On the wire, in bytes beside the frame
PREAMBLE_BYTES: Final = 8
FCS_BYTES: Final = 4
GAP_BYTES: Final = 12
BYTE_NS: Final = 80
"""Time of a byte at 100 Mbit/s."""

FMMU: Final = Struct("<IHBBHBBB3x")
"""Logical address, length, first and last bit, physical address, first bit, type, active."""
FMMU_READ: Final = 1
FMMU_WRITE: Final = 2
SYNC_MANAGER: Final = Struct("<HHBBBB")
"""Start, length, control, status, activation, control by the slave."""
SM_MODE_MASK: Final = 0x03
SM_MAILBOX: Final = 0x02
SM_MASTER_WRITES: Final = 0x04
SM_DIRECTION_MASK: Final = 0x0C
SM_WATCHDOG: Final = 0x40
SM_FULL: Final = 0x08
"""Bit of the status: the mailbox holds a message."""
SM_ENABLE: Final = 0x01
SM_REPEAT: Final = 0x02
"""Bit of activation (request) and of the slave's control (acknowledge)."""

MAILBOX: Final = Struct("<HHBB")
"""Length, address, channel and priority, type and counter (bits 4 to 6)."""


class MailboxType(IntEnum):
    """What a mailbox message holds."""

    ERROR = 0
    AOE = 1
    EOE = 2
    COE = 3
    FOE = 4
    SOE = 5
    VOE = 15


class MailboxError(IntEnum):
    """Details of a mailbox error."""

    SYNTAX = 1
    UNSUPPORTED_PROTOCOL = 2
    INVALID_CHANNEL = 3
    SERVICE_NOT_SUPPORTED = 4
    INVALID_HEADER = 5
    SIZE_TOO_SHORT = 6
    NO_MORE_MEMORY = 7
    INVALID_SIZE = 8


MAILBOX_ERROR: Final = Struct("<HH")
"""1, detail."""
COE: Final = Struct("<H")
"""Service in bits 12 to 15."""


class CoeService(IntEnum):
    """Services of CoE."""

    EMERGENCY = 1
    SDO_REQUEST = 2
    SDO_RESPONSE = 3
    TXPDO = 4
    RXPDO = 5
    TXPDO_REMOTE = 6
    RXPDO_REMOTE = 7
    SDO_INFORMATION = 8


SDO: Final = Struct("<BHB")
"""Command, index, sub-index; 4 bytes of data or size follow."""
SDO_INFORMATION: Final = Struct("<BBH")
"""Operation (bit 7: more fragments follow), reserved, number of fragments that follow."""
COE_EMERGENCY: Final = Struct("<HB5s")
"""Code, error register, data of the maker."""

# SII, word addresses
SII_ALIAS: Final = 0x04
SII_CHECKSUM: Final = 0x07
SII_VENDOR: Final = 0x08
SII_MAILBOX: Final = 0x18
"""Receive offset, receive size, send offset, send size."""
SII_PROTOCOLS: Final = 0x1C
SII_SIZE: Final = 0x3E
SII_FIRST_CATEGORY: Final = 0x40
SII_END: Final = 0xFFFF


def received_after_ns(frame_bytes: int) -> int:
    """Return the time from the begin of a frame on a wire until its last byte is in, ns."""
    return (PREAMBLE_BYTES + max(frame_bytes, FRAME_MIN) + FCS_BYTES) * BYTE_NS
