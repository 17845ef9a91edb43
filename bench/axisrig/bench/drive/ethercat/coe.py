"""CoE of a slave: SDO over the mailbox, and what it says of services that it does not have.

Source: docs/ethercat.md; CiA 301 for the commands. An abort goes out with the service of a request.
"""

import struct
from collections.abc import Callable
from typing import Final

from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.bench.drive.ethercat.object_access import ObjectAccess
from axisrig.kernel.profiles.ethercat.layouts import COE, MAILBOX, SDO, CoeService

_COMMAND: Final = 0xE0
_UPLOAD, _DOWNLOAD, _SEGMENT_UP, _SEGMENT_DOWN, _ABORT = 0x40, 0x20, 0x60, 0x00, 0x80
_COMPLETE: Final = 0x10
_TOGGLE: Final = 0x10
_EXPEDITED: Final = 0x02
_SIZED: Final = 0x01
_EXPEDITED_MAX: Final = 4
_SEGMENT_MIN: Final = 7
_SIZE: Final = struct.Struct("<I")


class SdoServer:
    """Answers SDO requests. size(): bytes of the mailbox to the master."""

    def __init__(self, objects: ObjectAccess, size: Callable[[], int]) -> None:
        self._objects, self._size = objects, size
        self._rest: bytes | None = None  # of an upload
        self._received: bytearray | None = None  # of a download
        self._announced = 0
        self._toggle = 0
        self._key = (0, 0)
        self._is_complete = False

    def reset(self) -> None:
        """Drop a transfer that is under way."""
        self._rest = self._received = None
        self._toggle = 0

    def request(self, body: bytes) -> bytes:
        """Return the answer to a request, both with their CoE heads."""
        data = body[COE.size :]
        if len(data) < SDO.size:
            return self._abort(AbortCode.COMMAND)
        try:
            return self._take(data)
        except SdoAbortedError as error:
            self.reset()
            return self._abort(error.code)

    def _take(self, data: bytes) -> bytes:
        first = data[0]
        command = first & _COMMAND
        if command == _SEGMENT_UP:
            return self._next_up(first)
        if command == _SEGMENT_DOWN:
            return self._next_down(first, data[1:])
        _, index, sub = SDO.unpack_from(data)
        self.reset()
        self._key, self._is_complete = (index, sub), bool(first & _COMPLETE)
        if command == _ABORT:
            return b""
        if command == _UPLOAD:
            return self._upload()
        if command == _DOWNLOAD:
            return self._download(first, data[SDO.size :])
        abort(AbortCode.COMMAND)

    def _upload(self) -> bytes:
        value = self._objects.upload(*self._key, complete=self._is_complete)
        first = 0x40 | (_COMPLETE if self._is_complete else 0)
        if 0 < len(value) <= _EXPEDITED_MAX:
            head = first | _EXPEDITED | _SIZED | _EXPEDITED_MAX - len(value) << 2
            return self._answer(head, value.ljust(_EXPEDITED_MAX, b"\x00"))
        most = self._size() - MAILBOX.size - COE.size - SDO.size - _SIZE.size
        part, rest = value[:most], value[most:]
        if rest:
            self._rest = rest
        return self._answer(first | _SIZED, _SIZE.pack(len(value)) + part)

    def _next_up(self, first: int) -> bytes:
        if self._rest is None:
            abort(AbortCode.COMMAND)
        self._check_toggle(first)
        most = self._size() - MAILBOX.size - COE.size - 1
        part, self._rest = self._rest[:most], self._rest[most:]
        head = self._toggle | (0 if self._rest else 1)
        if len(part) < _SEGMENT_MIN:
            head |= _SEGMENT_MIN - len(part) << 1
        self._toggle ^= _TOGGLE
        if not self._rest:
            self.reset()
        return _response(bytes((head,)) + part.ljust(_SEGMENT_MIN, b"\x00"))

    def _download(self, first: int, data: bytes) -> bytes:
        if len(data) < _EXPEDITED_MAX:
            abort(AbortCode.LENGTH)
        if first & _EXPEDITED:
            size = _EXPEDITED_MAX - (first >> 2 & 3) if first & _SIZED else None
            self._store(data[:_EXPEDITED_MAX], size)
            return self._written()
        (announced,) = _SIZE.unpack_from(data)
        received = bytearray(data[_SIZE.size :][:announced])
        self._objects.check_size(*self._key, announced, complete=self._is_complete)
        if len(received) == announced:
            self._store(bytes(received), announced)
            return self._written()
        self._received, self._announced, self._toggle = received, announced, 0
        return self._written()

    def _next_down(self, first: int, data: bytes) -> bytes:
        received = self._received
        if received is None:
            abort(AbortCode.COMMAND)
        self._check_toggle(first)
        toggle, is_last = first & _TOGGLE, bool(first & 1)
        unused = first >> 1 & 7 if len(data) == _SEGMENT_MIN else 0
        received += data[: len(data) - unused]
        if len(received) > self._announced:
            abort(AbortCode.TOO_LONG)
        self._toggle ^= _TOGGLE
        if is_last:
            if len(received) != self._announced:
                abort(AbortCode.LENGTH)
            value = bytes(received)
            self.reset()
            self._store(value, len(value))
        return _response(bytes((0x20 | toggle,)).ljust(8, b"\x00"))

    def _store(self, data: bytes, size: int | None) -> None:
        if size is None:  # the client leaves the length to the object
            size = self._objects.writable_size(*self._key)
        self._objects.download(*self._key, data[:size], complete=self._is_complete)

    def _check_toggle(self, first: int) -> None:
        if first & _TOGGLE != self._toggle:
            abort(AbortCode.TOGGLE)

    def _written(self) -> bytes:
        return self._answer(0x60 | (_COMPLETE if self._is_complete else 0), bytes(4))

    def _answer(self, first: int, data: bytes) -> bytes:
        return _response(SDO.pack(first, *self._key) + data)

    def _abort(self, code: int) -> bytes:
        head = COE.pack(CoeService.SDO_REQUEST << 12)
        return head + SDO.pack(_ABORT, *self._key) + _SIZE.pack(code)


def _response(data: bytes) -> bytes:
    return COE.pack(CoeService.SDO_RESPONSE << 12) + data
