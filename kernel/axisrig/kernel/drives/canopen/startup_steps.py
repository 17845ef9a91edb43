"""What is sent to a drive before it runs, as a list of steps made from the rig's declaration.

The order is that of CiA 302-2 (boot-up of a slave) and, inside a PDO, of CiA 301: disabled by
bit 31 of its COB-ID, mapping emptied, entries, their number, type, enabled. `startup.py` runs it.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Final, Literal

from canopen.objectdictionary import ObjectDictionary

from axisrig.kernel.drives.canopen.dcf import dcf_values
from axisrig.kernel.drives.canopen.dictionary import (
    allowed_values,
    check_mapping,
    check_objects,
    encode,
    variable,
)
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.drives.cia402.objects import object_name
from axisrig.kernel.errors import UserError
from axisrig.kernel.profiles.canopen.identifiers import (
    BIT_30,
    MAPPING_OF_PDO,
    NOT_VALID,
    PDO_BASE,
    SYNC_ID,
)
from axisrig.kernel.profiles.canopen.nmt import RESET_COMMUNICATION, RESET_NODE, START
from axisrig.kernel.time.clock import MS, TimeNs

PROFILE_MASK = 0xFFFF  # low word of 1000: number of the device profile
DRIVE_PROFILE = 402
CSP, CSV = 8, 9
TPDO_PARAMETERS: Final = range(0x1800, 0x1A00)  # communication parameters, CiA 301
INTERPOLATION: Final = 0x60C2
INDICES: Final = range(0, -10, -1)  # powers of ten of a second, down to a nanosecond

Boot = Literal["reset_communication", "reset_node", "wait", "none"]
_BOOT_COMMAND: Mapping[str, int | None] = {
    "reset_communication": RESET_COMMUNICATION, "reset_node": RESET_NODE, "wait": None,
}  # fmt: skip
IDENTITY = {"vendor": 1, "product": 2, "revision": 3, "serial": 4}  # sub-indices of 1018
OPTIONS = {
    "quick_stop": 0x605A, "shutdown": 0x605B, "disable_operation": 0x605C, "halt": 0x605D,
    "fault_reaction": 0x605E, "abort_connection": 0x6007,
}  # fmt: skip
# Objects that the scaling is computed from: encoder, gear, feed (CiA 402-2)
SCALING = ((0x608F, 1), (0x608F, 2), (0x6091, 1), (0x6091, 2), (0x6092, 1), (0x6092, 2))


@dataclass(frozen=True)
class BusSettings:
    """What all drives of the machine share.

    sync_period_us: 1006 and 60C2. sync_counter: overflow of the SYNC counter 1019, 0 = SYNC without
    data. heartbeat_ms: of the kernel's own heartbeat, 0 = none; master_node: its node id.
    """

    sync_period_us: int = 1000
    sync_counter: int = 0
    heartbeat_ms: int = 0
    master_node: int = 127


@dataclass(frozen=True)
class StartUpSettings:
    """The declaration of one kind of drive (rig table `[drive.D]`); objects in the field names.

    boot: how the drive gets to pre-operational. device_type: profile number that 1000 must
    show, None = not looked at. identity: sub-index of 1018 -> value. mode: 6060.
    sync_window_us: 1007, None = left alone. heartbeat_ms: 1017, 0 = off. consumer_ms: time of the
    drive's watch over the kernel (1016:1), 0 = none. guard_time_ms, life_factor: 100C, 100D.
    options: index -> code. scaling_check: compare 608F, 6091, 6092 with the rig. rpdo_timeout_ms:
    deadline of every cyclic RPDO (14xx:5) where the drive has one, 0 = none.
    writes: (index, sub-index, value) in their order.
    """

    boot: Boot = "reset_communication"
    boot_timeout_ns: TimeNs = 1000 * MS
    boot_attempts: int = 3
    sdo_timeout_ns: TimeNs = 300 * MS
    sdo_attempts: int = 2
    device_type: int | None = DRIVE_PROFILE
    identity: Mapping[int, int] = field(default_factory=dict)
    mode: int = CSP
    sync_window_us: int | None = None
    heartbeat_ms: int = 0
    consumer_ms: int = 0
    guard_time_ms: int = 0
    life_factor: int = 0
    options: Mapping[int, int] = field(default_factory=dict)
    scaling_check: bool = True
    rpdo_timeout_ms: int = 0
    writes: Sequence[tuple[int, int, int]] = ()


@dataclass(frozen=True)
class Scaling:
    """What the rig says of the position on the bus.

    encoder_increments: per motor revolution. units_per_revolution: position units of 607A and
    6064 per motor revolution.
    """

    encoder_increments: int
    units_per_revolution: Fraction


@dataclass(frozen=True)
class BootUp:
    """Send an NMT command (None: none) and wait for the boot-up message."""

    name: str
    command: int | None


@dataclass(frozen=True)
class Write:
    """Write an object."""

    name: str
    index: int
    sub: int
    data: bytes


@dataclass(frozen=True)
class Check:
    """Read an object and compare it (`value & mask == expected`)."""

    name: str
    index: int
    sub: int
    expected: int
    mask: int = 0xFFFFFFFF


@dataclass(frozen=True)
class Keep:
    """Read an object that an RPDO will carry, so that the first one changes nothing."""

    name: str
    index: int
    sub: int
    signed: bool


@dataclass(frozen=True)
class CheckScaling:
    """Read the objects of `SCALING` and compare what they say with the rig."""

    name: str
    expected: Scaling


@dataclass(frozen=True)
class Nmt:
    """Send an NMT command."""

    name: str
    command: int


Step = BootUp | Write | Check | Keep | CheckScaling | Nmt


def start_up_steps(
    settings: StartUpSettings,
    bus: BusSettings,
    telegrams: Mapping[str, Telegram],
    node_id: int,
    scaling: Scaling,
    od: ObjectDictionary,
) -> tuple[Step, ...]:
    """Return the steps that lead one drive to operational.

    Raises UserError for an object, type or mapping that the drive does not have.
    """
    check_mapping(od, telegrams.values())
    return tuple(_steps(settings, bus, telegrams, node_id, scaling, od))


def _steps(
    settings: StartUpSettings,
    bus: BusSettings,
    telegrams: Mapping[str, Telegram],
    node_id: int,
    scaling: Scaling,
    od: ObjectDictionary,
) -> Iterator[Step]:
    if settings.boot != "none":
        yield BootUp("boot-up", _BOOT_COMMAND[settings.boot])
    yield from _identity(settings)
    for found in dcf_values(od):
        name = f"DCF: {object_name(found.index, found.sub)} {found.name} = {found.value!r}"
        yield Write(name, found.index, found.sub, found.data)
    yield from _sync(settings, bus, od)
    yield from _left_out(telegrams, node_id, od)
    for telegram in telegrams.values():
        yield from _telegram(telegram, node_id, od, settings.rpdo_timeout_ms)
    yield from _behaviour(settings, scaling, od)
    yield from _kept(telegrams)
    yield from _guarding(settings, bus, od)
    yield Nmt("NMT start", START)


def object_steps(
    settings: StartUpSettings,
    period_us: int,
    telegrams: Mapping[str, Telegram],
    scaling: Scaling,
    od: ObjectDictionary,
) -> tuple[Step, ...]:
    """Return the steps that are about objects alone, for a carrier without NMT and COB-IDs.

    telegrams: what is mapped. Raises UserError for an object or type that the drive does not have.
    """
    for telegram in telegrams.values():
        check_objects(od, telegram)
    return (
        *_identity(settings),
        *_interpolation(period_us, od),
        *_behaviour(settings, scaling, od),
        *_kept(telegrams),
    )


def _identity(settings: StartUpSettings) -> Iterator[Step]:
    if settings.device_type is not None:
        yield Check("0x1000:0 device type", 0x1000, 0, settings.device_type, PROFILE_MASK)
    for sub, value in settings.identity.items():
        yield Check(f"{object_name(0x1018, sub)} identity", 0x1018, sub, value)


def _behaviour(settings: StartUpSettings, scaling: Scaling, od: ObjectDictionary) -> Iterator[Step]:
    """Mode, scaling, reactions, and what the rig writes besides."""
    yield _write(od, 0x6060, 0, settings.mode)
    if settings.scaling_check and all(variable(od, *place) for place in SCALING):
        yield CheckScaling("scaling", scaling)
    for index, value in settings.options.items():
        yield _write(od, index, 0, value)
    for index, sub, value in settings.writes:
        yield _write(od, index, sub, value)


def _kept(telegrams: Mapping[str, Telegram]) -> Iterator[Step]:
    """Objects that are sent in each cycle for drive functions: the first one changes nothing."""
    for telegram in telegrams.values():
        for mapped in telegram.objects if telegram.is_received else ():
            if not mapped.field:
                name = f"{object_name(mapped.index, mapped.sub)} as it is"
                yield Keep(name, mapped.index, mapped.sub, mapped.signed)


def _write(
    od: ObjectDictionary, index: int, sub: int, value: int, name: str | None = None
) -> Write:
    # What CiA 301 lays down for PDOs, bit 31 and 0 entries on the way, no limit of an EDS knows
    data = encode(od, index, sub, value, minds_limits=name is None)
    found = variable(od, index, sub)
    described = "" if found is None or name else f" {found.name}"
    shown = f"0x{value:X}" if value > 9 else value
    purpose = f"{name}: " if name else ""
    text = f"{purpose}{object_name(index, sub)}{described} = {shown}"
    return Write(text, index, sub, data)


def _sync(settings: StartUpSettings, bus: BusSettings, od: ObjectDictionary) -> Iterator[Step]:
    """SYNC consumer of the drive; 1019 may be changed only while 1006 is 0 (CiA 301 7.5.2.22)."""
    if _can_write(od, 0x1005):
        yield _write(od, 0x1005, 0, SYNC_ID)
    if bus.sync_counter:
        yield _write(od, 0x1006, 0, 0)
        yield _write(od, 0x1019, 0, bus.sync_counter)
    if settings.sync_window_us is not None:
        yield _write(od, 0x1007, 0, settings.sync_window_us)
    if _can_write(od, 0x1006):
        yield _write(od, 0x1006, 0, bus.sync_period_us)
    yield from _interpolation(bus.sync_period_us, od)


def _interpolation(period_us: int, od: ObjectDictionary) -> Iterator[Step]:
    """60C2, the time from one set position to the next, where the drive has it.

    Source: CiA 402-2, time = value * 10^index s. Of the pairs that the drive takes the one with the
    smallest value; an index that cannot be written stays as it is. Raises UserError for none.
    """
    value_at, index_at = (variable(od, INTERPOLATION, sub) for sub in (1, 2))
    if value_at is None or index_at is None or not value_at.writable:
        return
    values = allowed_values(value_at)
    is_fixed = not index_at.writable
    indices = (index_at.default or 0,) if is_fixed else allowed_values(index_at)
    time = Fraction(period_us, 1_000_000)
    pairs = {index: time / Fraction(10) ** index for index in INDICES if index in indices}
    for index, value in pairs.items():
        if value.denominator == 1 and value.numerator in values:
            yield _write(od, INTERPOLATION, 1, value.numerator)
            if not is_fixed:
                yield _write(od, INTERPOLATION, 2, index)
            return
    raise UserError(
        "the period of the NC cycle cannot be written to object 60C2, interpolation time period",
        value=f"{period_us} us",
        allowed=f"{values[0]} to {values[-1]} times a power of ten of a second,"
        f" exponents {', '.join(map(str, pairs))}",
        hint="choose another period_us of [cycle]",
    )


def _can_write(od: ObjectDictionary, index: int, sub: int = 0) -> bool:
    found = variable(od, index, sub)
    return found is not None and bool(found.writable)


def _left_out(
    telegrams: Mapping[str, Telegram], node_id: int, od: ObjectDictionary
) -> Iterator[Step]:
    """Switch off every TPDO of the drive that is not in the mapping, however it was left.

    One that is valid by default, or was stored so, would be sent all the same and take bus time.
    """
    mapped = {telegram.communication_index for telegram in telegrams.values()}
    for index in TPDO_PARAMETERS:
        found = variable(od, index, 1) if index in od and index not in mapped else None
        if found is not None and found.writable:
            name = f"TPDO{index - TPDO_PARAMETERS[0] + 1}"
            predefined = PDO_BASE[name] + node_id if name in PDO_BASE else 0
            cob_id = found.default or predefined
            yield _write(od, index, 1, cob_id | NOT_VALID, f"{name} off")


def _telegram(
    telegram: Telegram, node_id: int, od: ObjectDictionary, rpdo_timeout_ms: int
) -> Iterator[Step]:
    name = f"mapping of {telegram.name}"
    communication = telegram.communication_index
    mapping, cob_id = communication + MAPPING_OF_PDO, telegram.cob_id(node_id)

    def write(index: int, sub: int, value: int) -> Write:
        return _write(od, index, sub, value, name)

    is_fixed = _has_fixed_identifier(telegram, cob_id, od)
    if not is_fixed:
        yield write(communication, 1, cob_id | NOT_VALID)
    entries = [(0, len(telegram.objects)), *enumerate((o.entry for o in telegram.objects), 1)]
    if not all(_is_fixed_at(od, mapping, sub, value) for sub, value in entries):
        yield write(mapping, 0, 0)
        for position, entry in entries[1:]:
            yield write(mapping, position, entry)
        yield write(mapping, 0, len(telegram.objects))
    if not _is_fixed_at(od, communication, 2, telegram.transmission):
        yield write(communication, 2, telegram.transmission)
    if telegram.inhibit_100us:
        yield write(communication, 3, telegram.inhibit_100us)
    if telegram.event_ms:
        yield write(communication, 5, telegram.event_ms)
    watched = telegram.is_received and telegram.is_cyclic and rpdo_timeout_ms
    if watched and _can_write(od, communication, 5):
        yield write(communication, 5, rpdo_timeout_ms)
    if not is_fixed:
        yield write(communication, 1, cob_id)


def _is_fixed_at(od: ObjectDictionary, index: int, sub: int, value: int, bits: int = ~0) -> bool:
    """Whether an object cannot be written and has this value already, in these bits."""
    found = variable(od, index, sub)
    if found is None or found.writable or not isinstance(found.default, int):
        return False
    return found.default & bits == value


def _has_fixed_identifier(telegram: Telegram, cob_id: int, od: ObjectDictionary) -> bool:
    """Whether a PDO has an identifier that cannot be changed; raises UserError for another one.

    Bit 30 (no remote request) is the drive's own affair.
    """
    index = telegram.communication_index
    found = variable(od, index, 1)
    if found is None or found.writable or found.default is None:
        return False
    if not _is_fixed_at(od, index, 1, cob_id, ~BIT_30):
        raise UserError(
            f"{telegram.name} has an identifier that the drive does not let be changed"
            f" ({object_name(index, 1)} is {found.access_type})",
            value=f"0x{cob_id:X}",
            allowed=f"0x{found.default:X}",
        )
    return True


def _guarding(settings: StartUpSettings, bus: BusSettings, od: ObjectDictionary) -> Iterator[Step]:
    if settings.heartbeat_ms and settings.guard_time_ms:
        raise UserError(
            "a drive is watched by heartbeat or by node guarding, not by both",
            value=f"heartbeat_ms = {settings.heartbeat_ms}",
            allowed="one of heartbeat_ms, guard_time_ms",
        )
    if settings.heartbeat_ms:
        yield _write(od, 0x1017, 0, settings.heartbeat_ms)
    if settings.guard_time_ms:
        yield _write(od, 0x100C, 0, settings.guard_time_ms)
        yield _write(od, 0x100D, 0, settings.life_factor)
    if settings.consumer_ms:
        if not bus.heartbeat_ms:
            raise UserError(
                "the drive is to watch the kernel, but the kernel sends no heartbeat",
                value=f"consumer_ms = {settings.consumer_ms}",
                hint="set heartbeat_ms in [cycle]",
            )
        yield _write(od, 0x1016, 1, bus.master_node << 16 | settings.consumer_ms)
