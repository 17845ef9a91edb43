"""Records of the frames on EtherCAT segments: a hash over all, and files for other tools."""

import hashlib
import struct
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Final

from axisrig.bench.bus.ethercat.pcapng import PcapngFile
from axisrig.bench.bus.journal import Entry, Journal

_HEAD: Final = struct.Struct("<q")
_LENGTH: Final = struct.Struct("<I")


class EthercatHash:
    """SHA-256 over every frame that came back to its master, in the order of their ends.

    Per frame these bytes without padding, all integers little-endian:

    | bytes | content |
    |---|---|
    | 8 | time_ns, signed: when its last byte was back at the master |
    | 1 + n | length of the segment name, the name in UTF-8 |
    | 4 | length of the frame |
    | m | the frame from its destination address on, without FCS |
    """

    def __init__(self, journal: Journal) -> None:
        self._hash = hashlib.sha256()
        self._journal = journal
        self._frames = 0
        journal.add(self.take)

    def take(self, block: list[Entry]) -> None:
        """Add frames."""
        self._frames += len(block)
        for time_ns, segment, frame, _ in block:
            name = segment.encode()
            self._hash.update(_HEAD.pack(time_ns) + bytes((len(name),)) + name)
            self._hash.update(_LENGTH.pack(len(frame)) + frame)

    @property
    def frames(self) -> int:
        """How many frames there have been."""
        self._journal.drain()
        return self._frames

    def hexdigest(self) -> str:
        """Return the hash of what there has been so far; adding may go on."""
        self._journal.drain()
        return self._hash.hexdigest()


class PcapngLog:
    """The frames of a journal in a pcapng file, an interface for each segment.

    segments: their names. A context manager; it takes what the journal still holds at its end.
    """

    def __init__(self, path: Path, segments: Sequence[str], journal: Journal) -> None:
        self._file = PcapngFile(path, segments)
        self._places: Mapping[str, int] = {name: n for n, name in enumerate(segments)}
        self._journal = journal
        journal.add(self.take)

    def __enter__(self) -> "PcapngLog":
        return self

    def __exit__(self, *error: object) -> None:
        self._journal.drain()
        self._file.__exit__(*error)

    def take(self, block: list[Entry]) -> None:
        """Write frames."""
        for time_ns, segment, frame, _ in block:
            self._file.add(time_ns, self._places[segment], frame)
