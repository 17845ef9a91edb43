"""SDO server of the drive: expedited, segmented and block transfer in both directions.

Source: CiA 301, SDO protocols. One transfer at a time; a new initiate request takes the place of
one that is under way, of which nothing has been written. A frame that has not 8 bytes is no SDO
and gets no answer.
"""

import struct
from dataclasses import replace
from functools import partial
from typing import Final, Protocol

from canopen.sdo.exceptions import SdoAbortedError

from axisrig.bench.drive.axis.timer import Timer
from axisrig.bench.drive.canopen.sdo_transfers import (
    BlockDownload,
    BlockUpload,
    SegmentedDownload,
    SegmentedUpload,
    SegmentOutlet,
    Transfer,
)
from axisrig.bench.drive.cia402.dictionary.aborts import AbortCode, abort
from axisrig.kernel.time.clock import MS, Clock, Phase, TimeNs

TIMEOUT_NS: Final = 1000 * MS  # how long a transfer waits for its client
EXPEDITED_MAX: Final = 4
BLOCK_SIZE_MAX: Final = 127

_INITIATE: Final = struct.Struct("<BHBI")
_DOWNLOAD_SEGMENT, _DOWNLOAD, _UPLOAD, _UPLOAD_SEGMENT = 0, 1, 2, 3
_ABORT, _BLOCK_UPLOAD, _BLOCK_DOWNLOAD = 4, 5, 6


class Objects(Protocol):
    """The values that the server reads and writes; every method raises SdoAbortedError."""

    def upload(self, index: int, sub: int) -> bytes:
        """Return the bytes of an object."""
        ...

    def writable_size(self, index: int, sub: int) -> int | None:
        """Return how many bytes a write has, None for any number of them."""
        ...

    def download(self, index: int, sub: int, data: bytes) -> None:
        """Write an object."""
        ...


class SdoServer:
    """Answers one client.

    outlet: how answers of 8 bytes are sent. delay_ns: how long a request waits to be looked at.
    """

    def __init__(
        self, objects: Objects, clock: Clock, outlet: SegmentOutlet, delay_ns: TimeNs = 0
    ) -> None:
        self._objects, self._outlet, self._send = objects, outlet, outlet.send
        self._clock, self._delay_ns = clock, delay_ns
        self._run = 0  # counts the stops: a request that waited through one is forgotten
        self._transfer: Transfer | None = None
        self._key = (0, 0)  # object of the last request; an abort names it
        self._timeout = Timer(clock, self._timed_out)

    def stop(self) -> None:
        """Forget what is under way without a word."""
        self._run += 1
        self._end()

    def on_request(self, data: bytes) -> None:
        """Answer a frame of the client; nothing that it can contain raises."""
        if len(data) != 8:
            return
        if self._delay_ns:
            due_ns = self._clock.now_ns + self._delay_ns
            serve = partial(self._serve_late, self._run, data)
            self._clock.call_at(due_ns, Phase.APPLICATION, serve)
        else:
            self._serve(data)

    def _serve_late(self, run: int, data: bytes) -> None:
        if run == self._run:
            self._serve(data)

    def _serve(self, data: bytes) -> None:
        try:
            self._handle(data)
        except SdoAbortedError as refusal:
            self._end()
            self._send_abort(refusal.code)

    def _handle(self, data: bytes) -> None:
        transfer = self._transfer
        command = data[0] >> 5
        if isinstance(transfer, BlockDownload) and transfer.takes_segments and data[0] != 0x80:
            self._go_on(transfer, data)  # segments of a block have no command specifier
        elif command == _ABORT:
            self._end()
        elif self._is_initiate(command, data[0]):
            self._end()
            self._initiate(command, data)
        elif transfer is not None and command == transfer.command:
            self._go_on(transfer, data)
        else:
            abort(AbortCode.COMMAND)

    @staticmethod
    def _is_initiate(command: int, first: int) -> bool:
        if command == _BLOCK_UPLOAD:
            return first & 3 == 0
        return command in (_DOWNLOAD, _UPLOAD) or (command == _BLOCK_DOWNLOAD and first & 1 == 0)

    def _initiate(self, command: int, data: bytes) -> None:
        first, index, sub, size = _INITIATE.unpack(data)
        self._key = index, sub
        if command == _UPLOAD:
            self._initiate_upload(self._objects.upload(index, sub))
        elif command == _DOWNLOAD:
            self._initiate_download(first, size if first & 1 else None, data)
        elif command == _BLOCK_DOWNLOAD:
            limit = self._checked_size(size if first & 2 else None)
            self._start(BlockDownload(limit, has_crc=bool(first & 4)))
            self._answer(0xA4, size=BLOCK_SIZE_MAX)
        else:
            self._initiate_block_upload(bool(first & 4), data[4], data[5])

    def _initiate_upload(self, value: bytes) -> None:
        size = len(value)
        if 0 < size <= EXPEDITED_MAX:
            head = struct.pack("<BHB", 0x43 | EXPEDITED_MAX - size << 2, *self._key)
            self._send(head + value.ljust(EXPEDITED_MAX, b"\x00"))
        else:
            self._start(SegmentedUpload(value))
            self._answer(0x41, size=size)

    def _initiate_download(self, first: int, size: int | None, data: bytes) -> None:
        if not first & 2:
            self._start(SegmentedDownload(self._checked_size(size)))
        else:
            length = self._objects.writable_size(*self._key)
            if size is not None:  # otherwise the client leaves the length to the object
                length = EXPEDITED_MAX - (first >> 2 & 3)
            elif length is None:
                length = EXPEDITED_MAX
            elif length > EXPEDITED_MAX:
                abort(AbortCode.TOO_SHORT)
            self._objects.download(*self._key, data[4 : 4 + length])
        self._answer(0x60)

    def _initiate_block_upload(self, has_crc: bool, block_size: int, switch_size: int) -> None:
        value = self._objects.upload(*self._key)
        if not 1 <= block_size <= BLOCK_SIZE_MAX:
            abort(AbortCode.BLOCK_SIZE)
        if len(value) <= switch_size:
            self._initiate_upload(value)
            return
        outlet = replace(self._outlet, send=self._send_segment)
        self._start(BlockUpload(value, block_size, has_crc, outlet))
        self._answer(0xC6, size=len(value))

    def _checked_size(self, announced: int | None) -> int | None:
        """Return the size that a write must have; refuse an announced one that is another."""
        size = self._objects.writable_size(*self._key)
        if size is None:
            return announced
        if announced is not None and announced != size:
            abort(AbortCode.TOO_LONG if announced > size else AbortCode.TOO_SHORT)
        return size

    def _go_on(self, transfer: Transfer, data: bytes) -> None:
        answer = transfer.on_frame(data)
        if transfer.received is not None:
            self._objects.download(*self._key, transfer.received)
        if transfer.is_done:
            self._end()
        else:
            self._timeout.start(TIMEOUT_NS)
        if answer is not None:
            self._send(answer)

    def _start(self, transfer: Transfer) -> None:
        self._transfer = transfer
        self._timeout.start(TIMEOUT_NS)

    def _end(self) -> None:
        if self._transfer is not None:
            self._transfer.is_done = True
            self._transfer = None
            self._timeout.stop()

    def _send_segment(self, data: bytes) -> None:
        """Send a segment of a block: the client has time again from here on."""
        self._timeout.start(TIMEOUT_NS)
        self._send(data)

    def _timed_out(self) -> None:
        self._end()
        self._send_abort(AbortCode.TIMED_OUT)

    def _answer(self, first: int, size: int = 0) -> None:
        self._send(_INITIATE.pack(first, *self._key, size))

    def _send_abort(self, code: int) -> None:
        self._send(_INITIATE.pack(0x80, *self._key, code))
