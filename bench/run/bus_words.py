"""A bus log in words: one line per frame, in the terms of CANopen and of the drive profile.

With the rig the frames have the names of its axes and the values of their PDOs; without it only
what the identifiers of the pre-defined connection set tell.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import can

from bench.bus.dissect import BOOT_UP, NMT_COMMANDS, STATES, Dissected, dissect, sdo_words
from bench.bus.frame import Frame
from bench.bus.logs import LOG_SUFFIXES
from bench.drive.objects import variables
from bench.results.stored import read_results
from bench.rig.check import axis_telegrams
from bench.rig.settings import Settings
from bench.run.replay import recorded_case
from bench.run.runner import settings_of
from kernel.drives.ds402 import find_state
from kernel.drives.emergency import Emergency
from kernel.drives.mapping import Telegram
from kernel.drives.sdo import abort_text, object_name
from kernel.errors import UserError

READABLE = [LOG_SUFFIXES[kind] for kind in ("blf", "candump", "asc")]
STATUSWORD = 0x6041
# Objects whose bits are read, not their number
_WORDS = {0x1001, 0x6040, 0x6041, 0x603F, 0x60B8, 0x60B9, 0x60FD}
EPOCH_S = 1e8
"""A later first time is a date: times are then told from the first frame on."""


@dataclass(frozen=True)
class Selection:
    """Which frames are shown. only: words, one of which the line must hold; all of them if empty.

    from_ms, to_ms: since the start of the log. is_all: also SYNCs, and PDOs that bring nothing new.
    """

    only: tuple[str, ...] = ()
    from_ms: float = 0.0
    to_ms: float = float("inf")
    is_all: bool = False


def find_log(place: Path, run: str | None) -> tuple[Path, Settings | None]:
    """Return the log that is meant, and the settings of its run where it lies in a results folder.

    Raises UserError when there is none.
    """
    if not place.is_dir():
        if not place.is_file() or place.suffix.lower() not in READABLE:
            raise UserError("no bus log that can be read", value=str(place), allowed=READABLE)
        return place, None
    runs = [stored.run for stored in read_results(place).runs]
    if run is None:
        raise UserError("which run of the folder?", file=place, allowed=runs)
    case, _ = recorded_case(place, run)
    found = [place / "bus" / f"{run}{suffix}" for suffix in READABLE]
    for path in found:
        if path.is_file():
            return path, settings_of(case)
    raise UserError(
        "the run left no bus log that can be read", file=place / "bus", allowed=READABLE
    )


def tell_log(path: Path, settings: Settings | None, selection: Selection) -> Iterator[str]:
    """Yield the lines for the frames of a log. Raises UserError for a damaged one."""
    names = _Names(settings)
    last: dict[tuple[str, int], object] = {}
    with can.LogReader(path) as reader:
        for time_ms, message in _times(reader):
            if time_ms < selection.from_ms:
                continue
            if time_ms > selection.to_ms:
                return
            segment = names.segment(message.channel)
            frame = Frame(
                message.arbitration_id,
                bytes(message.data),
                message.is_extended_id,
                message.is_remote_frame,
                message.dlc,
            )
            told = dissect(frame, is_error=message.is_error_frame)
            key = (segment, frame.arbitration_id)
            content = told.fields.get("state", frame.data) if _is_heartbeat(told) else frame.data
            is_old = _repeats(told) and key in last and last[key] == content
            last[key] = content
            if is_old and not selection.is_all:
                continue
            name, text = names.tell(segment, frame, told)
            line = f"{time_ms:13.6f}  {segment:<6} {frame.arbitration_id:03X}  {name:<16} {text}"
            if not selection.only or any(word in line for word in selection.only):
                yield line.rstrip()


def _times(messages: Iterable[can.Message]) -> Iterator[tuple[float, can.Message]]:
    """Yield time in ms and message; times count from the first frame where they are dates."""
    iterator = iter(messages)
    first = next(iterator, None)
    if first is None:
        return
    origin_s = first.timestamp if first.timestamp > EPOCH_S else 0.0
    for message in chain([first], iterator):
        yield (message.timestamp - origin_s) * 1e3, message


def _repeats(told: Dissected) -> bool:
    """Whether a frame comes cyclically, so that it is worth a line only when it has changed.

    A boot-up never does: it says that a node has started anew.
    """
    if _is_heartbeat(told):
        return told.fields.get("state") != BOOT_UP
    return told.service == "SYNC" or "PDO" in told.service


def _is_heartbeat(told: Dissected) -> bool:
    return told.service == "heartbeat" and "remote" not in told.fields


class _Names:
    """What a rig calls its segments, nodes and telegrams."""

    def __init__(self, settings: Settings | None) -> None:
        self._segments = list(settings.rig.segment) if settings else []
        self._nodes: dict[tuple[str, int], str] = {}
        self._telegrams: dict[tuple[str, int], tuple[str, Telegram]] = {}
        for name, axis in settings.rig.axis.items() if settings else ():
            self._nodes[axis.segment, axis.node] = name
            assert settings is not None
            for telegram in axis_telegrams(settings, name).values():
                self._telegrams[axis.segment, telegram.cob_id(axis.node)] = (name, telegram)

    def segment(self, channel: object) -> str:
        """Return the name of a segment; logs with numbers count from 0 in the order of the rig."""
        if isinstance(channel, int) and channel < len(self._segments):
            return self._segments[channel]
        if channel is None and len(self._segments) == 1:
            return self._segments[0]
        return "" if channel is None else str(channel)

    def tell(self, segment: str, frame: Frame, told: Dissected) -> tuple[str, str]:
        """Return the name of a frame and what it says."""
        if told.service == "error frame":
            return "error frame", ""
        known = self._telegrams.get((segment, frame.arbitration_id))
        if known is not None and not frame.is_remote_frame:
            axis, telegram = known
            return f"{axis}.{telegram.name}", _pdo_words(telegram, frame.data)
        name = told.service
        if told.node is not None:
            name = f"{self._nodes.get((segment, told.node), told.node)}.{told.service}"
        return name, _words(told)


def _pdo_words(telegram: Telegram, data: bytes) -> str:
    """Say the values of a PDO; one of another length is shown as it is."""
    if len(data) != telegram.length:
        return f"{data.hex(' ')} ({len(data)} bytes, {telegram.length} are mapped)"
    values = telegram.codec.unpack(data)
    return ", ".join(
        _value_words(item.index, item.sub, item.bits, value)
        for item, value in zip(telegram.objects, values, strict=True)
    )


def _value_words(index: int, sub: int, bits: int, value: int) -> str:
    row = variables().get((index, sub))
    name = row.name if row is not None else object_name(index, sub)
    if index not in _WORDS:
        return f"{name} {value}"
    text = f"{name} 0x{value:0{bits // 4}X}"
    if index == STATUSWORD:
        state = find_state(value)
        text += f" ({state.name.lower().replace('_', ' ') if state else 'no state'})"
    return text


def _words(told: Dissected) -> str:
    """Say what a frame carries that is no known PDO."""
    fields, service = told.fields, told.service
    if fields.get("remote"):
        return "remote frame"
    if service.startswith("SDO "):
        return _sdo_words(service.removeprefix("SDO "), fields)
    text = _bytes(fields, "data").hex(" ")
    if service == "NMT" and "command" in fields:
        command, target = _int(fields, "command"), _int(fields, "target")
        whom = f"node {target}" if target else "all nodes"
        text = f"{NMT_COMMANDS.get(command, f'command {command}')}, {whom}"
    elif service == "heartbeat" and "state" in fields:
        state = _int(fields, "state")
        text = STATES.get(state, f"state {state}") + (", toggle bit" if fields["toggle"] else "")
    elif service == "EMCY" and "code" in fields:
        emergency = Emergency(_int(fields, "code"), _int(fields, "register"), b"")
        text = f"{emergency}, {_bytes(fields, 'vendor').hex(' ')}"
    elif service == "SYNC" and fields:
        text = f"counter {_int(fields, 'counter')}"
    return text


def _bytes(fields: Mapping[str, int | bytes], name: str) -> bytes:
    value = fields.get(name, b"")
    return value if isinstance(value, bytes) else bytes([value & 0xFF])


def _int(fields: Mapping[str, int | bytes], name: str) -> int:
    value = fields.get(name, 0)
    return value if isinstance(value, int) else int.from_bytes(value, "little")


def _sdo_words(side: str, fields: Mapping[str, int | bytes]) -> str:
    text = sdo_words(side, _int(fields, "specifier"))
    if "index" in fields:
        key = (_int(fields, "index"), _int(fields, "sub"))
        row = variables().get(key)
        text += f" {object_name(*key)}" + (f" {row.name}" if row is not None else "")
    if "abort_code" in fields:
        return f"{text}: {abort_text(_int(fields, 'abort_code'))}"
    value = fields.get("value")
    if isinstance(value, bytes):
        number = int.from_bytes(value, "little")
        return f"{text} = {number} (0x{number:0{2 * len(value)}X})"
    if "size" in fields:
        return f"{text}, {_int(fields, 'size')} bytes follow"
    data = fields.get("data")
    if isinstance(data, bytes):
        return f"{text} {data.hex(' ')}{', the last one' if fields['is_last'] else ''}"
    return text
