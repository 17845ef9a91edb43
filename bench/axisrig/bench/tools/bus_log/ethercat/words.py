"""What a frame on an EtherCAT line says: datagrams, states, mailbox, process image."""

from collections.abc import Iterator
from dataclasses import dataclass, field

from axisrig.bench.bus.ethercat.frame import Datagram, datagrams, working_counter
from axisrig.bench.rig.ethercat.members import (
    TERMINAL,
    TERMINAL_BYTES,
    axes_on,
    ec_segments,
    terminal_on,
    terminal_position,
)
from axisrig.bench.rig.ethercat.on_line import axis_pdos
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.canopen.object_words import name_of, number_of, value_words
from axisrig.bench.tools.bus_log.ethercat.idents import carried_words, message_words
from axisrig.kernel.drives.cia402.objects import object_name
from axisrig.kernel.drives.ethercat.image import Image, codec_of
from axisrig.kernel.drives.ethercat.settings import STATION_BASE, RegisterInputs, SlaveSettings
from axisrig.kernel.profiles.canopen.aborts import abort_text
from axisrig.kernel.profiles.canopen.emergency import Emergency
from axisrig.kernel.profiles.ethercat.layouts import MAILBOX, SDO, CoeService, MailboxType
from axisrig.kernel.profiles.ethercat.tables import (
    AL_ERROR,
    Command,
    al_status_text,
    registers,
    state_name,
)
from axisrig.kernel.profiles.sercos.service import HEADER, ident_name

_LOGICAL = (Command.LRD, Command.LWR, Command.LRW)
_FIRST_RAM = 0x1000
_TIME_REGISTER = 0x0910
_HEAD = 2  # of CoE
_PART_MIN = 7
"""A part of an SDO transfer has so many bytes at least; the command counts those that are none."""


@dataclass
class Described:
    """A datagram in words. tags: what `--only` may ask for. is_usual: the same in each cycle."""

    name: str
    text: str
    tags: set[str] = field(default_factory=set)
    is_usual: bool = False


class LineNames:
    """Says frames; with settings also whose they are, and the values of the process image."""

    def __init__(self, settings: Settings | None) -> None:
        self._settings = settings
        self._axes: dict[str, list[str]] = {}
        self._images: dict[str, Image] = {}
        for name in ec_segments(settings) if settings is not None else ():
            assert settings is not None
            self._axes[name] = axes_on(settings, name)
            others = [_terminal(settings, name)] if terminal_on(settings, name) else []
            self._images[name] = Image(
                [_layout(settings, axis, n) for n, axis in enumerate(self._axes[name], 1)], others
            )

    @property
    def axes(self) -> list[str]:
        """Axes on lines."""
        return [axis for axes in self._axes.values() for axis in axes]

    def describe(self, segment: str, frame: bytes) -> Iterator[Described]:
        """Say each datagram of a frame; one for each axis of a process image."""
        for datagram in datagrams(frame):
            data = frame[datagram.data_start : datagram.data_start + datagram.length]
            counter = working_counter(frame, datagram)
            if datagram.command in _LOGICAL:
                yield from self._image(segment, datagram, data, counter)
            else:
                yield self._physical(segment, datagram, data, counter)

    # Process image

    def _image(
        self, segment: str, datagram: Datagram, data: bytes, counter: int
    ) -> Iterator[Described]:
        name = Command(datagram.command).name
        image = self._images.get(segment)
        if image is None or image.size != datagram.length:
            yield Described(name, f"WKC {counter}  {data.hex(' ')}", {"image"})
            return
        wrong = "" if counter == image.counter else f"  WRONG, {image.counter} expected"
        for axis, place in zip(self._axes[segment], image.places, strict=True):
            yield from self._values(axis, data, place.outputs, counter, wrong, is_output=True)
            yield from self._values(axis, data, place.inputs, counter, wrong, is_output=False)
        for at in image.registers:
            shown = data[at : at + TERMINAL_BYTES].hex(" ")
            tags = {f"{TERMINAL}.inputs", TERMINAL, "image"}
            yield Described(
                f"{TERMINAL}.inputs", f"WKC {counter}{wrong}  from 09AE on {shown}", tags
            )

    def _values(
        self, axis: str, data: bytes, at: int, counter: int, wrong: str, *, is_output: bool
    ) -> Iterator[Described]:
        assert self._settings is not None
        outputs, inputs = axis_pdos(self._settings, axis)
        objects = outputs.objects if is_output else inputs.objects
        codec = codec_of(objects)
        drive = self._settings.rig.drive[self._settings.rig.axis[axis].drive]
        per_mm = drive.facts().units_per_mm
        numbers = codec.unpack(data[at : at + codec.size])
        if drive.has_idents:
            pairs = zip(objects, numbers, strict=True)
            words = [carried_words(o, number, float(per_mm)) for o, number in pairs]
            names = {ident_name(o.index).lower() for o in objects}
        else:
            words = [
                f"{name_of(o.index, o.sub)} "
                + value_words(o.index, o.sub, o.bits, number, per_mm, hexadecimal=False)
                for o, number in zip(objects, numbers, strict=True)
            ]
            names = {f"{o.index:04x}" for o in objects}
        name = f"{axis}.{'outputs' if is_output else 'inputs'}"
        text = f"WKC {counter}{wrong}  {'; '.join(words)}"
        tags = {name.lower(), axis.lower(), "image", *names}
        yield Described(name, text, tags)

    # Registers and mailboxes

    def _physical(self, segment: str, datagram: Datagram, data: bytes, counter: int) -> Described:
        command = Command(datagram.command).name
        position, register = datagram.address & 0xFFFF, datagram.address >> 16
        axis = self._whose(segment, datagram.command, position)
        name = f"{axis or '-'}.{command}"
        tags = {command.lower(), *([axis.lower()] if axis else [])}
        if register >= _FIRST_RAM:
            text, more = _mailbox(data)
            return Described(name, f"WKC {counter}  {text}", tags | more)
        known = next((row for row in registers().values() if row.address == register), None)
        where = known.name if known is not None else f"0x{register:04X}"
        text = f"WKC {counter}  {where} {_value(where, data)}"
        is_usual = register == _TIME_REGISTER or command == Command.BRD.name
        return Described(name, text, tags | {where.lower()}, is_usual)

    def _whose(self, segment: str, command: int, position: int) -> str:
        axes = self._axes.get(segment, [])
        if command in (Command.FPRD, Command.FPWR, Command.FPRW, Command.FRMW):
            number = position - STATION_BASE
            return axes[number - 1] if 0 < number <= len(axes) else str(position)
        return ""


def _layout(settings: Settings, axis: str, number: int) -> SlaveSettings:
    outputs, inputs = axis_pdos(settings, axis)
    return SlaveSettings(
        axis=axis, increments_per_mm=1.0, node_id=number, outputs=(outputs,), inputs=(inputs,)
    )


def _terminal(settings: Settings, segment: str) -> RegisterInputs:
    position = terminal_position(settings, segment)
    return RegisterInputs(axis=TERMINAL, node_id=position, first=0, size=TERMINAL_BYTES)


def _value(register: str, data: bytes) -> str:
    """Say the data of a register, states with their names."""
    if register == "AL_CONTROL" and data:
        asked = state_name(data[0] & ~AL_ERROR)
        return f"{asked}, acknowledges an error" if data[0] & AL_ERROR else asked
    if register == "AL_STATUS" and data:
        code = int.from_bytes(data[4:6], "little")
        return state_name(data[0]) + (f" ({al_status_text(code)})" if code else "")
    return data.hex(" ")


def _mailbox(data: bytes) -> tuple[str, set[str]]:
    """Say a mailbox message, or bytes of the memory that are none."""
    if not any(data) or len(data) < MAILBOX.size:
        return "nothing", {"mailbox"}
    length, _, _, kind = MAILBOX.unpack_from(data)
    body = data[MAILBOX.size : MAILBOX.size + length]
    if kind & 0xF == MailboxType.SOE and len(body) >= HEADER.size:
        text, more = message_words(body)
        return text, {"mailbox"} | more
    if kind & 0xF != MailboxType.COE or len(body) < _HEAD + SDO.size:
        return f"mailbox {data[: MAILBOX.size + length].hex(' ')}", {"mailbox"}
    return _coe(int.from_bytes(body[:2], "little") >> 12, body[_HEAD:])


def _coe(service: int, content: bytes) -> tuple[str, set[str]]:
    """Say a message of CoE and what `--only` may ask for. content: behind its head."""
    if service == CoeService.EMERGENCY:
        return f"EMCY {Emergency.read(bytearray(content[:8]))}", {"emcy"}
    is_answer = service == CoeService.SDO_RESPONSE
    if service != CoeService.SDO_REQUEST and not is_answer:
        names = {each.value: each.name.lower().replace("_", " ") for each in CoeService}
        return f"CoE {names.get(service, service)}, {content.hex(' ')}", {"mailbox"}
    command, index, sub = SDO.unpack_from(content)
    if command >> 5 in ((0, 1) if is_answer else (0, 3)):
        return _segment(content, is_answer=is_answer), {"sdo"}
    tags = {"sdo", f"{index:04x}", f"{index:04x}:{sub:x}"}
    return _sdo(content, is_answer=is_answer), tags


def _segment(content: bytes, *, is_answer: bool) -> str:
    """Say a part of an SDO transfer that comes after the first one; it names no object."""
    command, part = content[0], content[1:]
    if command >> 5:
        return "SDO written, a part" if is_answer else "SDO read, the next part"
    count = len(part) - (command >> 1 & 7 if len(part) <= _PART_MIN else 0)
    last = ", the last one" if command & 1 else ""
    return f"SDO {'answer' if is_answer else 'write'}, a part of {count} bytes{last}"


def _sdo(content: bytes, *, is_answer: bool) -> str:
    """Say a message of an SDO transfer that names its object."""
    command, index, sub = SDO.unpack_from(content)
    item, rest = object_name(index, sub), content[SDO.size :]
    name = " ".join(dict.fromkeys((item, name_of(index, sub))))
    if command == 0x80:
        return f"SDO abort {item}: {abort_text(int.from_bytes(rest[:4], 'little'))}"
    if not is_answer and command >> 5 == 2:
        return f"SDO read {name}"
    if is_answer and command >> 5 == 3:
        return f"SDO written {item}"
    what = "SDO answer" if is_answer else "SDO write"
    if not command & 2:
        return f"{what} {name}, {int.from_bytes(rest[:4], 'little')} bytes"
    plain = rest[: 4 - (command >> 2 & 3 if command & 1 else 0)]
    number = number_of(index, sub, plain)
    shown = value_words(index, sub, 8 * len(plain), number, None, hexadecimal=True)
    return f"{what} {name} = {shown}"
