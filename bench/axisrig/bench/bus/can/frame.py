"""Classical CAN frames: what competes in arbitration and how many bits go over the wire.

The length is exact: the real payload with its CRC-15 and its real stuff bits. Source: Robert Bosch
GmbH, CAN Specification 2.0 (1991), part A sections 3.1.1 (frame), 5 (coding) and part B.
"""

from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise
from typing import Final, NamedTuple, TypeAlias

from axisrig.kernel.time.clock import TimeNs

IFS_BITS: Final = 3
"""Intermission after every frame; the next frame starts after it."""

TAIL_BITS: Final = 10
"""Never stuffed: CRC delimiter, acknowledge slot and delimiter, seven bits of end of frame."""

CRC_POLYNOMIAL, CRC_BITS = 0x4599, 15
STANDARD_ID_MAX: Final = 0x7FF
EXTENDED_ID_MAX: Final = 0x1FFF_FFFF
DATA_BYTES_MAX: Final = 8
KNOWN_FRAMES: Final = 4096

_STATES = [(bit, run) for bit in (0, 1) for run in (1, 2, 3, 4)]
"""Last bit on the wire and how often it was there in a row; a fifth is stuffed at once."""

_Row: TypeAlias = list[tuple[int, "_Row"]]
"""A row of the stuff table, see `_stuff_rows`."""


class Frame(NamedTuple):
    """One data or remote frame; attribute names as in `can.Message`.

    arbitration_id: 11 or 29 bits. data: bytes on the wire, none in a remote frame.
    dlc: 0..8, equals len(data) except in a remote frame.
    """

    arbitration_id: int
    data: bytes
    is_extended_id: bool
    is_remote_frame: bool
    dlc: int


FrameObserver: TypeAlias = Callable[[TimeNs, str, Frame, bool], None]
"""Called as observer(time_ns, segment, frame, is_error) at every end of frame."""


def identifier_text(can_id: int, is_extended: bool) -> str:
    """Write an identifier in hexadecimal: of 11 bits three digits, of 29 bits eight."""
    return f"{can_id:08X}" if is_extended else f"{can_id:03X}"


def data_frame(can_id: int, data: bytes) -> Frame:
    """Make a data frame; identifiers above 0x7FF are extended ones.

    Raises ValueError for an identifier above 29 bits or more than 8 bytes.
    """
    if not 0 <= can_id <= EXTENDED_ID_MAX:
        raise ValueError(f"identifier {can_id:#x} is outside 0..{EXTENDED_ID_MAX:#x}")
    if len(data) > DATA_BYTES_MAX:
        raise ValueError(f"{len(data)} data bytes in a classical CAN frame")
    return Frame(can_id, bytes(data), can_id > STANDARD_ID_MAX, False, len(data))


def arbitration_key(can_id: int, extended: bool, remote: bool) -> int:
    """Return the arbitration field as a number: of two frames the smaller one wins.

    32 bits in wire order: 11-bit base, RTR or SRR, IDE, 18-bit extension, RTR. A standard data
    frame beats the remote frame of its identifier, and that beats extended ones of that base.
    """
    if extended:
        return (can_id >> 18) << 21 | 0b11 << 19 | (can_id & 0x3FFFF) << 1 | remote
    return can_id << 21 | remote << 20


def worst_case_bits(data_bytes: int, extended: bool = False) -> int:
    """Longest a data frame with `data_bytes` can get, in bits including the intermission.

    Standard: 47 + 8n + floor((34 + 8n - 1) / 4); extended has 20 more bits that may be stuffed.
    Source: R. I. Davis, A. Burns, R. J. Bril, J. J. Lukkien, "Controller Area Network (CAN)
    schedulability analysis: refuted, revisited and revised", Real-Time Systems 35 (2007), eq. 1.
    """
    stuffable = (54 if extended else 34) + 8 * data_bytes
    return stuffable + (stuffable - 1) // 4 + TAIL_BITS + IFS_BITS


def _crc_step(crc: int, bit: int) -> int:
    """Shift one bit into the CRC register (Bosch CAN 2.0 part A, 3.1.1, CRC sequence)."""
    feedback = (crc >> 14) ^ bit
    crc = (crc << 1) & 0x7FFF
    return crc ^ CRC_POLYNOMIAL if feedback else crc


def _stuff_step(state: int, bit: int) -> tuple[int, int]:
    """Send one bit from a state of `_STATES`; return the next state and the stuff bits added."""
    last, run = _STATES[state]
    run = run + 1 if bit == last else 1
    if run == 5:
        return _STATES.index((1 - bit, 1)), 1
    return _STATES.index((bit, run)), 0


def _bits(value: int, width: int) -> list[int]:
    """Most significant bit first, as on the wire."""
    return [value >> place & 1 for place in reversed(range(width))]


def _stuff_rows() -> list[_Row]:
    """Tabulate `_stuff_step`: for each state a row of (stuff bits, row of the next state).

    Entry n of a row is for the 8 bits of n, entry 256 + n for the 7 bits of n.
    """
    rows: list[_Row] = [[] for _ in _STATES]
    for start, row in enumerate(rows):
        for width in (8, 7):
            for chunk in range(1 << width):
                state, count = start, 0
                for bit in _bits(chunk, width):
                    state, more = _stuff_step(state, bit)
                    count += more
                row.append((count, rows[state]))
    return rows


def _crc_tables() -> list[list[int]]:
    """Give, for each count of data bytes after it, what a byte adds to the CRC.

    The CRC is linear: the contributions of header and bytes are added (exclusive or).
    """
    table = []
    for byte in range(256):
        crc = 0
        for bit in _bits(byte, 8):
            crc = _crc_step(crc, bit)
        table.append(crc)
    tables = [table]
    while len(tables) < DATA_BYTES_MAX:
        tables.append([_crc_shifted(crc) for crc in tables[-1]])
    return tables


def _crc_shifted(crc: int) -> int:
    """Shift eight bits 0 into the CRC register."""
    for _ in range(8):
        crc = _crc_step(crc, 0)
    return crc


_ROWS = _stuff_rows()
_CRC_TABLES = _crc_tables()


def _header_bits(can_id: int, extended: bool, remote: bool, dlc: int) -> list[int]:
    """Return the bits from SOF to the DLC, without stuff bits."""
    if extended:
        arbitration = [*_bits(can_id >> 18, 11), 1, 1, *_bits(can_id, 18), int(remote), 0, 0]
    else:
        arbitration = [*_bits(can_id, 11), int(remote), 0, 0]
    return [0, *arbitration, *_bits(dlc, 4)]


@lru_cache(maxsize=8192)
def _head(
    can_id: int, extended: bool, remote: bool, dlc: int, size: int
) -> tuple[int, _Row, int, list[list[int]]]:
    """Return what does not depend on the data of a frame with `size` bytes of them.

    That is the CRC of the header, the row of the stuff table after the DLC, the length in bits
    without the stuff bits that follow, and the table of the CRC for each data byte.
    """
    wire = _header_bits(can_id, extended, remote, dlc)
    crc = 0
    for bit in wire:
        crc = _crc_step(crc, bit)
    for _ in range(size):
        crc = _crc_shifted(crc)
    state, added = _STATES.index((0, 1)), 0
    for _, bit in pairwise(wire):
        state, more = _stuff_step(state, bit)
        added += more
    bits = len(wire) + added + 8 * size + CRC_BITS + TAIL_BITS + IFS_BITS
    return crc, _ROWS[state], bits, _CRC_TABLES[:size][::-1]


def frame_bits(frame: Frame) -> int:
    """Return the exact length in bits from SOF to the end of the intermission."""
    can_id, data, extended, remote, dlc = frame
    crc, row, bits, tables = _head(can_id, extended, remote, dlc, len(data))
    for byte, crc_of in zip(data, tables, strict=True):
        crc ^= crc_of[byte]
        stuffed, row = row[byte]
        bits += stuffed
    stuffed, row = row[crc >> 7]
    return bits + stuffed + row[256 | crc & 0x7F][0]


class FrameLengths(dict[Frame, int]):
    """Exact lengths by frame, in bits as of `frame_bits`: `lengths[frame]` works out a new one.

    Most telegrams repeat: SYNC always, the others of an axis at rest. Holds KNOWN_FRAMES at most.
    """

    def __missing__(self, frame: Frame) -> int:
        """Work out a length and remember it."""
        if len(self) >= KNOWN_FRAMES:
            self.clear()
        bits = self[frame] = frame_bits(frame)
        return bits


LENGTHS = FrameLengths()
"""Of every bus of this process: a length follows from its frame alone, and the next run has most
of the same."""


def wire_bits(frame: Frame) -> str:
    """Return the levels from SOF to the end of the CRC with stuff bits; "0" is dominant."""
    can_id, data, extended, remote, dlc = frame
    bits = _header_bits(can_id, extended, remote, dlc)
    for byte in data:
        bits += _bits(byte, 8)
    crc = 0
    for bit in bits:
        crc = _crc_step(crc, bit)
    bits += _bits(crc, CRC_BITS)
    text, state = "0", _STATES.index((0, 1))
    for bit in bits[1:]:
        state, stuffed = _stuff_step(state, bit)
        text += f"{bit}{1 - bit}" if stuffed else str(bit)
    return text
