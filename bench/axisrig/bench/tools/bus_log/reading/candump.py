"""Logs of candump: of its option -l, and what it shows on the screen.

Those of -l are read as python-can does, but error frames keep their interface.
"""

import re
from calendar import timegm
from collections.abc import Iterator
from itertools import pairwise
from typing import Final

import can

from axisrig.bench.bus.can.logs import ERROR_FLAG
from axisrig.bench.tools.bus_log.reading.lines import SCREEN_FORM, Lines
from axisrig.kernel.errors import UserError

_ID_BITS: Final = 0x1FFF_FFFF
_STANDARD_DIGITS: Final = 3
_SHORT_TIME: Final = len("000.000000")
"""candump -t d and -t z write three digits of seconds, -t a writes ten."""
_DATE: Final = re.compile(r"(\d{4})-(\d\d)-(\d\d) (\d\d):(\d\d):(\d\d)(\.\d+)")
_BACK_AT_MOST: Final = 0.25


def read_candump(lines: Lines) -> Iterator[can.Message]:
    """Yield the frames of a log; raises what the reader of python-can raises for a damaged one.

    Error frames are those with the flag of SocketCAN, whatever their class (Linux can/error.h).
    """
    for message in can.CanutilsLogReader(lines):  # type: ignore[arg-type]
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


def read_screen(lines: Lines) -> list[can.Message]:
    """Return the frames of candump without -l; all times are 0 where the lines have none.

    Raises UserError where the times are those between frames, ValueError for a damaged line.
    """
    found, texts = list[can.Message](), list[str]()
    for line in lines:
        if not line.strip():
            continue
        parts = SCREEN_FORM.fullmatch(line.rstrip("\r\n"))
        if parts is None:
            raise ValueError("no line of candump")
        length, text = int(parts["length"]), parts["data"]
        is_remote = text.startswith("remote")
        can_id = int(parts["id"], 16)
        texts.append(parts["time"] or "")
        data = b"" if is_remote else bytes(int(word, 16) for word in text.split()[:length])
        if not is_remote and len(data) != length:
            raise ValueError(f"{len(data)} bytes, the line says {length}")
        found.append(
            can.Message(
                timestamp=_time_s(texts[-1]),
                channel=parts["channel"],
                arbitration_id=can_id & _ID_BITS,
                is_extended_id=len(parts["id"]) > _STANDARD_DIGITS,
                is_error_frame=len(parts["id"]) > _STANDARD_DIGITS and bool(can_id & ERROR_FLAG),
                is_remote_frame=is_remote,
                dlc=length,
                data=None if is_remote else data,
            )
        )
    _need_times_since_begin(found, texts)
    return found


def _time_s(text: str) -> float:
    if not text:
        return 0.0
    date = _DATE.fullmatch(text)
    if date is None:
        return float(text)
    return timegm(tuple(int(part) for part in date.groups()[:6])) + float(date[7])


def _need_times_since_begin(found: list[can.Message], texts: list[str]) -> None:
    times = [message.timestamp for message in found]
    back = sum(after < before for before, after in pairwise(times))
    is_short = all(len(text) == _SHORT_TIME for text in texts)
    if is_short and back > _BACK_AT_MOST * len(times):
        raise UserError(
            "the times of the log are those since the frame before (candump -t d), so that nobody"
            " knows the order of frames of two interfaces; record with candump -l, or -t a"
        )
