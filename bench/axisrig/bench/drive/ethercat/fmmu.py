"""FMMUs: where the logical process image lies in a slave, bit by bit.

Source: docs/ethercat.md. A datagram of logical addresses counts once for each direction in which
any FMMU of the slave was hit, whatever their number.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Final

from axisrig.kernel.profiles.ethercat.layouts import FMMU, FMMU_READ, FMMU_WRITE

COUNT: Final = 8
_LAST_BIT: Final = 7


class Physical(ABC):
    """The physical memory of a slave, as a frame that passes reads and writes it."""

    @abstractmethod
    def read(self, address: int, length: int) -> bytes | None:
        """Return what is there, None where a read is refused."""

    @abstractmethod
    def write(self, address: int, data: bytes) -> bool:
        """Write; return whether that is allowed."""


@dataclass(frozen=True)
class Fmmu:
    """An active one. first_bit, last_bit: of its first and last byte of the logical image."""

    logical: int
    length: int
    first_bit: int
    last_bit: int
    physical: int
    physical_bit: int
    kind: int

    @property
    def is_whole(self) -> bool:
        """Whether it maps whole bytes."""
        return self.first_bit == 0 and self.last_bit == _LAST_BIT and self.physical_bit == 0


def read_fmmus(registers: bytes) -> list[Fmmu]:
    """Return the active ones of the registers, 16 bytes each."""
    found = []
    for number in range(COUNT):
        *parts, active = FMMU.unpack_from(registers, FMMU.size * number)
        if active & 1 and parts[1]:
            logical, length, first, last, physical, bit, kind = parts
            found.append(
                Fmmu(
                    logical,
                    length,
                    first & _LAST_BIT,
                    last & _LAST_BIT,
                    physical,
                    bit & _LAST_BIT,
                    kind,
                )
            )
    return found


class Mapping:
    """The logical image of one slave in its memory."""

    def __init__(self, memory: Physical) -> None:
        self._memory = memory
        self.fmmus: list[Fmmu] = []

    def exchange(
        self, frame: bytearray, at: int, logical: int, length: int, reads: bool, writes: bool
    ) -> tuple[bool, bool]:
        """Act on a datagram whose data is at `at`; return whether it was read, and written.

        What is written was there before inputs were put in: both may lie at one logical address.
        """
        sent = bytes(frame[at : at + length]) if writes else b""
        was_read = was_written = False
        for fmmu in self.fmmus:
            begin = max(logical, fmmu.logical)
            end = min(logical + length, fmmu.logical + fmmu.length)
            if begin >= end:
                continue
            if reads and fmmu.kind & FMMU_READ:
                was_read |= self._get(fmmu, frame, at - logical, begin, end)
            if writes and fmmu.kind & FMMU_WRITE:
                was_written |= self._put(fmmu, sent, logical, begin, end)
        return was_read, was_written

    def _get(self, fmmu: Fmmu, frame: bytearray, base: int, begin: int, end: int) -> bool:
        if fmmu.is_whole:
            data = self._memory.read(fmmu.physical + begin - fmmu.logical, end - begin)
            if data is not None:
                frame[base + begin : base + end] = data
            return data is not None
        first, last = _bits(fmmu, begin, end)
        if last < first:
            return False  # none of its bits is in these bytes
        from_bit = first - fmmu.first_bit + fmmu.physical_bit
        to_bit = last - fmmu.first_bit + fmmu.physical_bit
        data = self._memory.read(fmmu.physical + from_bit // 8, to_bit // 8 - from_bit // 8 + 1)
        if data is None:
            return False
        bits = int.from_bytes(data, "little") >> from_bit % 8
        mask = (1 << last - first + 1) - 1
        place = first - 8 * (begin - fmmu.logical)
        held = int.from_bytes(frame[base + begin : base + end], "little")
        held = held & ~(mask << place) | (bits & mask) << place
        frame[base + begin : base + end] = held.to_bytes(end - begin, "little")
        return True

    def _put(self, fmmu: Fmmu, sent: bytes, logical: int, begin: int, end: int) -> bool:
        data = sent[begin - logical : end - logical]
        if fmmu.is_whole:
            return self._memory.write(fmmu.physical + begin - fmmu.logical, data)
        first, last = _bits(fmmu, begin, end)
        if last < first:
            return False
        mask = (1 << last - first + 1) - 1
        bits = int.from_bytes(data, "little") >> first - 8 * (begin - fmmu.logical) & mask
        to_bit = first - fmmu.first_bit + fmmu.physical_bit
        size = (to_bit % 8 + last - first) // 8 + 1
        # Bits of the first and last byte that are not mapped are written as 0
        return self._memory.write(
            fmmu.physical + to_bit // 8, (bits << to_bit % 8).to_bytes(size, "little")
        )


def _bits(fmmu: Fmmu, begin: int, end: int) -> tuple[int, int]:
    """Return the first and last bit of a part of the image, counted from its first byte on."""
    first = max(8 * (begin - fmmu.logical), fmmu.first_bit)
    last = min(8 * (end - fmmu.logical) - 1, 8 * (fmmu.length - 1) + fmmu.last_bit)
    return first, last
