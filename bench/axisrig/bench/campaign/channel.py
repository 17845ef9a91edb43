"""The channel on which a process apart answers: frames of known length with a checksum.

Foreign code in that process can write into any of its descriptors. What is no frame ends the
process, and nobody waits for the rest of one that does not come.
"""

import hashlib
import os
import pickle
import struct
import sys
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

MAGIC = b"axisrig\x01"
_HEAD = struct.Struct("<8sQ")  # magic, length of the content in bytes
_SUM_BYTES = hashlib.sha256().digest_size
ANSWER_BYTES_MAX = 256 << 20
"""So large an answer may be: what a run leaves is in files, and its answer a few megabytes."""
STALL_S = 30.0
"""So long a frame that has begun may stay as it is."""
_CHUNK = 1 << 20


class ChannelError(Exception):
    """What came is no answer; the text says why."""


def send(pipe: Connection, content: Any) -> None:
    """Send a frame. Raises OSError when nobody is there, ChannelError for one that is too large."""
    data = pickle.dumps(content)
    if len(data) > ANSWER_BYTES_MAX:
        raise ChannelError(f"the answer has {len(data)} bytes, at most {ANSWER_BYTES_MAX} may come")
    frame = _HEAD.pack(MAGIC, len(data)) + data + hashlib.sha256(data).digest()
    if sys.platform == "win32":
        pipe.send_bytes(frame)
        return
    rest = memoryview(frame)
    while rest:
        rest = rest[os.write(pipe.fileno(), rest) :]


class Inbox:
    """The parent's end: takes the frames of one process, as far as they are there; never waits."""

    def __init__(self, pipe: Connection, clock: Callable[[], float]) -> None:
        """Take the end of a channel, and what gives seconds of wall time."""
        self._pipe, self._clock = pipe, clock
        self._data = bytearray()
        self._changed_s = 0.0
        self._set_waiting(False)

    def _set_waiting(self, waits: bool) -> None:
        if sys.platform != "win32":
            os.set_blocking(self._pipe.fileno(), waits)

    def order(self, content: Any) -> None:
        """Send something to the process, as a whole. Raises OSError when it is there no more."""
        self._set_waiting(True)
        self._pipe.send(content)
        self._set_waiting(False)

    def take(self) -> Any:
        """Return what was sent next, None where nothing is there yet.

        Raises ChannelError for anything else than a frame, EOFError when the other end is closed,
        OSError when the channel is broken.
        """
        is_ended = False
        while (content := self._content()) is None and not is_ended:
            chunk = self._read()
            if chunk is None:
                break
            is_ended = not chunk
            self._data += chunk
            self._changed_s = self._clock()
        if content is not None:
            return content
        if is_ended:
            raise EOFError
        if self._data and self._clock() - self._changed_s > STALL_S:
            raise ChannelError(f"an answer broke off after {len(self._data)} bytes")
        return None

    def _content(self) -> Any:
        """Return the content of a whole frame at the begin of what is there."""
        head = bytes(self._data[: _HEAD.size])
        if not MAGIC.startswith(head[: len(MAGIC)]):
            raise ChannelError(f"{head[:16]!r} is no answer")
        if len(head) < _HEAD.size:
            return None
        _, length = _HEAD.unpack(head)
        if length > ANSWER_BYTES_MAX:
            raise ChannelError(f"an answer of {length} bytes, at most {ANSWER_BYTES_MAX} may come")
        end = _HEAD.size + length
        if len(self._data) < end + _SUM_BYTES:
            return None
        data = bytes(self._data[_HEAD.size : end])
        digest = bytes(self._data[end : end + _SUM_BYTES])
        del self._data[: end + _SUM_BYTES]
        if hashlib.sha256(data).digest() != digest:
            raise ChannelError("an answer does not fit its checksum")
        return pickle.loads(data)

    def _read(self) -> bytes | None:
        """Return what is there, None where that is nothing, empty at the end."""
        if sys.platform == "win32":
            return self._pipe.recv_bytes(ANSWER_BYTES_MAX + _CHUNK) if self._pipe.poll() else None
        try:
            return os.read(self._pipe.fileno(), _CHUNK)
        except BlockingIOError:
            return None
