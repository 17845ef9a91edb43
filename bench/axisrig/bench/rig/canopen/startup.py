"""How the drives of a rig are started: keys of `[drive.D]`, and the kernel's steps made of them."""

import re
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal

from canopen.objectdictionary import ObjectDictionary
from pydantic import AfterValidator, Field

from axisrig.bench.drive.cia402.dictionary.eds import object_dictionary
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.rig.reading.tables import Table
from axisrig.kernel.drives.canopen.dictionary import read_eds
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.drives.canopen.startup_steps import (
    CSP,
    CSV,
    IDENTITY,
    OPTIONS,
    BusSettings,
    Scaling,
    StartUpSettings,
    Step,
    start_up_steps,
)
from axisrig.kernel.drives.canopen.watch import WatchSettings
from axisrig.kernel.time.clock import MS

_OBJECT = re.compile(r"0x(?P<index>[0-9A-Fa-f]{4}):(?P<sub>0x[0-9A-Fa-f]{1,2}|[0-9]{1,3})")


def _object(text: object) -> tuple[int, int]:
    match = _OBJECT.fullmatch(text) if isinstance(text, str) else None
    sub = int(match["sub"], 0) if match else 256
    if match is None or sub > 255:
        raise ValueError(f"{text!r} is no object; write index and sub-index as in 0x6065:0")
    return int(match["index"], 16), sub


def _write(entry: list[str | int]) -> list[str | int]:
    if len(entry) != 2 or not isinstance(entry[1], int):
        raise ValueError('each write is an object and a whole number, ["0x6065:0", 1000]')
    _object(entry[0])
    return entry


def _position_mode(value: int) -> int:
    if value >= 0 and value not in (CSP, CSV):
        raise ValueError(
            "the kernel sends a set value every cycle: 8 (csp) follows positions, 9 (csv) speeds;"
            " a mode of the manufacturer has to follow positions"
        )
    return value


# No process under an ordinary operating system keeps a few milliseconds for sure
REAL_TIMEOUT_MS = 100
Write = Annotated[list[str | int], AfterValidator(_write)]
U16 = Annotated[int, Field(ge=0, le=0xFFFF)]
U32 = Annotated[int, Field(ge=0, le=0xFFFFFFFF)]
I16 = Annotated[int, Field(ge=-0x8000, le=0x7FFF)]


class StartUpKeys(Table):
    """The keys of `[drive.D]` that say how the kernel starts and watches the drive.

    docs/drives-and-kernel.md has them as a table with the objects that they set.
    """

    eds: str | None = None
    pdo_map: str | None = None
    boot: Literal["reset_communication", "reset_node", "wait", "none"] = "reset_communication"
    boot_timeout_ms: Annotated[int, Field(ge=1, le=600_000)] = 1000
    boot_attempts: Annotated[int, Field(ge=1, le=1000)] = 3
    sdo_timeout_ms: Annotated[int, Field(ge=1, le=600_000)] = 300
    sdo_attempts: Annotated[int, Field(ge=1, le=100)] = 2
    device_type: U16 | Literal[False] = 402
    identity: dict[Literal["vendor", "product", "revision", "serial"], U32] = Field(
        default_factory=dict
    )
    mode: Annotated[int, Field(ge=-128, le=127), AfterValidator(_position_mode)] = 8
    speed_loop_us: Annotated[float, Field(ge=0, le=1_000_000)] = 0.0
    sync_window_us: U32 | None = None
    heartbeat_ms: U16 = 0
    consumer_ms: U16 = 0
    guard_time_ms: U16 = 0
    life_factor: Annotated[int, Field(ge=0, le=255)] = 3
    options: dict[
        Literal[
            "quick_stop", "shutdown", "disable_operation", "halt", "fault_reaction",
            "abort_connection",
        ],
        I16,
    ] = Field(default_factory=dict)  # fmt: skip
    scaling_check: bool = True
    rpdo_timeout_ms: U16 | None = None
    lag_limit_mm: Annotated[float, Field(ge=0)] = 0.0
    fault_reset: bool = False
    missing_cycles: Annotated[int, Field(ge=1, le=1000)] = 3
    heartbeat_timeout_ms: U16 = 0
    latch_check: bool = True
    position_check: bool = True
    jump_factor: Annotated[float, Field(ge=0)] = 2.0
    homing_limit_s: Annotated[float, Field(gt=0, le=86_400)] = 300.0
    sdo: list[Write] = Field(default_factory=list)


def start_up_settings(keys: StartUpKeys) -> StartUpSettings:
    """Make the kernel's declaration of the keys of a drive."""
    return StartUpSettings(
        boot=keys.boot,
        boot_timeout_ns=keys.boot_timeout_ms * MS,
        boot_attempts=keys.boot_attempts,
        sdo_timeout_ns=keys.sdo_timeout_ms * MS,
        sdo_attempts=keys.sdo_attempts,
        device_type=None if keys.device_type is False else keys.device_type,
        identity={IDENTITY[name]: value for name, value in keys.identity.items()},
        mode=keys.mode,
        sync_window_us=keys.sync_window_us,
        heartbeat_ms=keys.heartbeat_ms,
        consumer_ms=keys.consumer_ms,
        guard_time_ms=keys.guard_time_ms,
        life_factor=keys.life_factor,
        options={OPTIONS[name]: value for name, value in keys.options.items()},
        scaling_check=keys.scaling_check,
        rpdo_timeout_ms=keys.rpdo_timeout_ms or 0,
        writes=[_declared(entry) for entry in keys.sdo],
    )


def watch_settings(keys: StartUpKeys) -> WatchSettings:
    """Make the kernel's watch of the keys of a drive."""
    timeout_ms = keys.heartbeat_timeout_ms or 2 * keys.heartbeat_ms
    return WatchSettings(timeout_ms * MS, keys.guard_time_ms * MS, keys.life_factor)


def _declared(entry: list[Any]) -> tuple[int, int, int]:
    index, sub = _object(entry[0])
    return index, sub, entry[1]


def drive_dictionary(keys: StartUpKeys, node_id: int, profile: DriveProfile) -> ObjectDictionary:
    """Return what the drive has: the EDS of the rig, else that of our own drive model.

    Raises UserError for an EDS that cannot be read.
    """
    if keys.eds is None:
        return object_dictionary(node_id, profile)
    file = Path(keys.eds)
    state = file.stat() if file.is_file() else None
    return _eds(keys.eds, node_id, state and (state.st_mtime_ns, state.st_size))


@cache
def _eds(path: str, node_id: int, _state: tuple[int, int] | None) -> ObjectDictionary:
    """Read an EDS once, as long as the file stays the same: a check asks for it often."""
    return read_eds(path, node_id)


def drive_steps(
    keys: StartUpKeys,
    bus: BusSettings,
    telegrams: dict[str, Telegram],
    node_id: int,
    profile: DriveProfile,
    *,
    is_real: bool = False,
) -> tuple[Step, ...]:
    """Return the steps that start one drive; raises UserError for what its EDS does not have.

    is_real: the bus is outside this process, where a cycle may be late.
    """
    od = drive_dictionary(keys, node_id, profile)
    scaling = Scaling(profile.encoder_increments, Fraction(profile.units_per_revolution))
    settings = start_up_settings(keys)
    if keys.rpdo_timeout_ms is None:
        # As many RPDOs may be lost as TPDOs; half a cycle is for the way over the bus
        half_cycles = 2 * keys.missing_cycles + 3
        timeout_ms = -(-half_cycles * bus.sync_period_us // 2000)
        timeout_ms = max(timeout_ms, REAL_TIMEOUT_MS) if is_real else timeout_ms
        settings = replace(settings, rpdo_timeout_ms=timeout_ms)
    return start_up_steps(settings, bus, telegrams, node_id, scaling, od)
