"""Frames of a bus in words, in the terms of CANopen and of the drive profile.

With the rig the frames have the names of its axes. What PDOs carry is taken from the SDO traffic of
the log itself, else from the rig, else frames are what the pre-defined connection set says.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from canopen.objectdictionary import ObjectDictionary

from axisrig.bench.bus.can.dissect import (
    BLOCK_END,
    BLOCK_START,
    BLOCK_TAKEN,
    NMT_COMMANDS,
    STATES,
    Dissected,
    sdo_words,
)
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.rig.canopen.members import can_axes, drive_of
from axisrig.bench.rig.canopen.schedule import axis_telegrams
from axisrig.bench.rig.canopen.startup import drive_dictionary
from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.bus_log.canopen.mapping import LoggedPdos, Pdo
from axisrig.bench.tools.bus_log.canopen.object_words import name_of, number_of, value_words
from axisrig.bench.tools.bus_log.canopen.transfers import Transfers
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.drives.cia402.objects import object_name
from axisrig.kernel.profiles.canopen.aborts import abort_text
from axisrig.kernel.profiles.canopen.emergency import Emergency
from axisrig.kernel.profiles.canopen.nmt import BOOT_UP

NOBODYS = "of no node of this rig"


@dataclass(frozen=True)
class Described:
    """A frame in words.

    name: whose, and which service. tags: what it can be asked for by, in lower case.
    """

    name: str
    text: str
    tags: frozenset[str]


class Names:
    """What a rig calls its nodes and telegrams, and the objects of those that have an EDS."""

    def __init__(self, settings: Settings | None) -> None:
        self._is_rig = settings is not None
        self._per_mm: dict[str, Fraction] = {}
        self._dictionaries: dict[tuple[str, int], ObjectDictionary] = {}
        self._nodes: dict[tuple[str, int], str] = {}
        self._transfers = Transfers()
        telegrams = {}
        for name in can_axes(settings) if settings else ():
            assert settings is not None
            axis = settings.rig.axis[name]
            self._nodes[axis.segment, axis.node_id] = name
            drive = drive_of(settings, name)
            self._per_mm[name] = drive.make().units_per_mm
            if drive.eds is not None:
                od = drive_dictionary(drive, axis.node_id, drive.make())
                self._dictionaries[axis.segment, axis.node_id] = od
            telegrams[axis.segment, axis.node_id] = axis_telegrams(settings, name)
        self._pdos = LoggedPdos(telegrams)

    @property
    def axes(self) -> list[str]:
        """Names of the axes, in the order of the rig."""
        return list(self._nodes.values())

    def follow(self, segment: str, frame: Frame, dissected: Dissected) -> Dissected:
        """Take a frame for what it is after all that came before; every frame in its order."""
        node = dissected.node
        if dissected.service.startswith("SDO ") and node is not None and not frame.is_remote_frame:
            dissected, value = self._transfers.take(segment, frame.data, dissected)
            if value is not None:
                number = int.from_bytes(value.data, "little")
                self._pdos.note(segment, node, value.index, value.sub, number)
        elif is_boot_up(dissected) and node is not None:
            self._transfers.forget(segment, node)
            self._pdos.forget(segment, node)
        pdo = self._pdo(segment, frame, dissected)
        return dissected if pdo is None else replace(dissected, service=pdo.name, node=pdo.node)

    def _pdo(self, segment: str, frame: Frame, dissected: Dissected) -> Pdo | None:
        is_error = dissected.service == "error frame"
        found = self._pdos.find(segment, frame.arbitration_id, frame.is_extended_id)
        return None if is_error else found

    def describe(self, segment: str, frame: Frame, dissected: Dissected) -> Described:
        """Return the name of a frame, what it says and what it can be asked for by.

        dissected: from `follow`.
        """
        if dissected.service == "error frame":
            return Described("error frame", "", frozenset(("error frame", "error")))
        known = self._pdo(segment, frame, dissected)
        telegram = known.telegram if known is not None else None
        if telegram is not None and dissected.node is not None and not frame.is_remote_frame:
            axis = self._nodes.get((segment, dissected.node))
            od = self._dictionaries.get((segment, dissected.node))
            text = _pdo_words(telegram, frame.data, self._per_mm.get(axis or ""), od)
            objects = [(item.index, item.sub) for item in telegram.objects]
            tags = _tags(
                telegram.name, [*([axis] if axis else []), str(dissected.node)], dissected, objects
            )
            whose = "" if axis or not self._is_rig else f", {NOBODYS}"
            return Described(f"{axis or dissected.node}.{telegram.name}", f"{text}{whose}", tags)
        fields = dissected.fields
        objects = [(_int(fields, "index"), _int(fields, "sub"))] if "index" in fields else []
        node = (
            dissected.node or (_int(fields, "target") if dissected.service == "NMT" else 0) or None
        )
        owner = self._nodes.get((segment, node)) if node is not None else None
        od = self._dictionaries.get((segment, node)) if node is not None else None
        text = _words(dissected, self._per_mm.get(owner) if owner else None, od)
        name = dissected.service
        if dissected.node is not None:
            name = f"{owner or dissected.node}.{dissected.service}"
        is_owned = owner is not None or (node is None and dissected.service != "unknown")
        if self._is_rig and not is_owned:
            text = f"{text}, {NOBODYS}" if text else NOBODYS
        who = [word for word in (owner, str(node) if node else None) if word]
        return Described(name, text, _tags(dissected.service, who, dissected, objects))


def _tags(
    service: str, who: Iterable[str], dissected: Dissected, objects: Iterable[tuple[int, int]]
) -> frozenset[str]:
    kinds = {service.lower(), service.lower().split()[0]}
    if "PDO" in service:
        kinds |= {"pdo", service[:4].lower()}
    if is_boot_up(dissected):
        kinds.add("boot-up")
    if "abort_code" in dissected.fields:
        kinds.add("abort")
    names = {name.lower() for name in who}
    tags = kinds | names | {f"{name}.{kind}" for name in names for kind in kinds}
    for index, sub in objects:
        tags |= {f"{index:04x}", f"{index:04x}:{sub:x}"}
    return frozenset(tags)


def is_boot_up(dissected: Dissected) -> bool:
    """Whether a node says that it has started anew."""
    return dissected.service == "heartbeat" and dissected.fields.get("state") == BOOT_UP


def _pdo_words(
    telegram: Telegram, data: bytes, per_mm: Fraction | None, od: ObjectDictionary | None
) -> str:
    """Say the values of a PDO; one of another length is shown as it is."""
    if len(data) != telegram.length:
        return f"{data.hex(' ')} ({len(data)} bytes, {telegram.length} are mapped)"
    values = telegram.codec.unpack(data)
    return ", ".join(
        f"{name_of(item.index, item.sub, od)} "
        + value_words(item.index, item.sub, item.bits, value, per_mm, hexadecimal=False)
        for item, value in zip(telegram.objects, values, strict=True)
    )


def _words(dissected: Dissected, per_mm: Fraction | None, od: ObjectDictionary | None) -> str:
    """Say what a frame carries that is no known PDO."""
    fields, service = dissected.fields, dissected.service
    if fields.get("remote"):
        return "remote frame"
    if service.startswith("SDO "):
        return _sdo_words(service.removeprefix("SDO "), fields, per_mm, od)
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


def _sdo_words(
    side: str,
    fields: Mapping[str, int | bytes],
    per_mm: Fraction | None,
    od: ObjectDictionary | None,
) -> str:
    text = sdo_words(side, _int(fields, "specifier"))
    if "index" in fields:
        key = (_int(fields, "index"), _int(fields, "sub"))
        text += f" {object_name(*key)}"
        name = name_of(*key, od)
        text += f" {name}" if name != object_name(*key) else ""
    if "abort_code" in fields:
        return f"{text}: {abort_text(_int(fields, 'abort_code')).removeprefix('abort ')}"
    value = fields.get("value")
    if isinstance(value, bytes):
        number, bits = number_of(*key, value, od), 8 * len(value)
        return f"{text} = {value_words(*key, bits, number, per_mm, hexadecimal=True)}"
    if "size" in fields:
        return f"{text}, {_int(fields, 'size')} bytes follow"
    if "step" in fields:
        return f"{text} {_block_words(fields)}"
    text += f", segment {_int(fields, 'segment')}:" if "segment" in fields else ""
    data = fields.get("data")
    if isinstance(data, bytes):
        return f"{text} {data.hex(' ')}{', the last one' if fields['is_last'] else ''}"
    return text


def _block_words(fields: Mapping[str, int | bytes]) -> str:
    """Say a frame of a block transfer that is neither its begin nor a segment."""
    step = _int(fields, "step")
    if step == BLOCK_TAKEN:
        return f"{_int(fields, 'taken')} segments taken, next {_int(fields, 'block_size')} at most"
    if step == BLOCK_END and "crc" in fields:
        unused = _int(fields, "unused")
        of = f"{unused} byte{'s' * (unused != 1)} of the last segment unused"
        return f"end, {of}, CRC 0x{_int(fields, 'crc'):04X}"
    return "start" if step == BLOCK_START else "end"
