"""Logs of candump -l: as python-can reads them, but error frames keep their interface."""

import io
from collections.abc import Iterator
from pathlib import Path

import can

from axisrig.bench.bus.can.logs import ERROR_FLAG


class _Lines(io.TextIOWrapper):
    """The lines of a file; `last` is the one that was given last."""

    last = ""

    def __iter__(self) -> Iterator[str]:  # type: ignore[override]
        while line := self.readline():
            self.last = line
            yield line


def read_candump(path: Path) -> Iterator[can.Message]:
    """Yield the frames of a log; raises what the reader of python-can raises for a damaged one.

    Error frames are those with the flag of SocketCAN, whatever their class (Linux can/error.h).
    """
    with path.open("rb") as file, _Lines(file, encoding="utf-8") as lines:
        for message in can.CanutilsLogReader(lines):
            _time, channel, frame = lines.last.split()[:3]
            can_id = int(frame.partition("#")[0], 16)
            if not can_id & ERROR_FLAG:
                yield message
                continue
            yield can.Message(
                timestamp=message.timestamp,
                channel=int(channel) if channel.isdigit() else channel,
                is_error_frame=True,
            )
