"""A pipe that holds one state: from a run to whoever looks on, in whichever processes both are.

The reader asks, the run answers between two of its cycles, and neither ever waits: a state takes
the place of the one before it, read or not, so that the newest wins. Both ends map one small file.
Nothing here knows a clock; how often the reader asks says how often a state is sent.
"""

import mmap
import struct
import zlib
from pathlib import Path

CAPACITY = 1 << 18
"""Bytes that a state may have."""
# A state that is wanted; number, length and checksum of the one that is there
_HEAD = struct.Struct("<?xxxxxxxQII")
_STATE = struct.Struct("<QII")
_SIZE = _HEAD.size + CAPACITY
_STATE_PLACE = _HEAD.size - _STATE.size


class Outlet:
    """The end of the run. Raises OSError when the file of the pipe is not there."""

    def __init__(self, path: Path) -> None:
        with path.open("r+b") as file:
            self._map = mmap.mmap(file.fileno(), _SIZE)

    @property
    def is_asked(self) -> bool:
        """Whether the reader wants a state."""
        return self._map[0] != 0

    def put(self, state: bytes) -> None:
        """Answer with a state; one that is too large to be held is left out."""
        pipe = self._map
        pipe[0] = 0
        if len(state) > CAPACITY:
            return
        number = _STATE.unpack_from(pipe, _STATE_PLACE)[0] + 1
        pipe[_HEAD.size : _HEAD.size + len(state)] = state
        _STATE.pack_into(pipe, _STATE_PLACE, number, len(state), zlib.crc32(state))


class Inlet:
    """The end of the reader, which makes the file. Raises OSError when that is not possible."""

    def __init__(self, path: Path) -> None:
        path.write_bytes(bytes(_SIZE))
        with path.open("r+b") as file:
            self._map = mmap.mmap(file.fileno(), _SIZE)
        self._number = 0

    def ask(self) -> None:
        """Ask for a state; one that is there already stays until the answer comes."""
        self._map[0] = 1

    def take(self) -> bytes | None:
        """Return the state that has come since the last call, None without one.

        One that is being replaced at this moment, or was left half written by a process that died,
        does not fit its checksum and counts as none.
        """
        number, length, checksum = _STATE.unpack_from(self._map, _STATE_PLACE)
        if number == self._number or length > CAPACITY:
            return None
        state = self._map[_HEAD.size : _HEAD.size + length]
        if zlib.crc32(state) != checksum:
            return None
        self._number = number
        return state

    def close(self) -> None:
        """Let go of the file."""
        self._map.close()
