"""The slaves of a rig: drives of its axes, and the stamping terminal of its PLC."""

from collections.abc import Callable
from functools import partial
from typing import Final

from axisrig.bench.drive.ethercat.node import EthercatDrive, SlaveSettings
from axisrig.bench.drive.ethercat.stamping import StampingTerminal
from axisrig.bench.drive.sercos.node import SercosDrive
from axisrig.bench.machine.ethercat.line_terminal import inputs_of
from axisrig.bench.machine.faults.beside import Beside
from axisrig.bench.rig.canopen.members import drive_of
from axisrig.bench.rig.ethercat.keys import SegmentTable
from axisrig.bench.rig.ethercat.members import TERMINAL, segment_of, terminal_on
from axisrig.bench.rig.reading.plc_task import silent_ns
from axisrig.bench.rig.sercos.keys import DriveTable as SercosTable
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.profiles.cia402.ds402 import State
from axisrig.kernel.time.clock import US, Phase, TimeNs
from axisrig.kernel.time.scheduler import Scheduler

Entered = Callable[[str, State], None]
ON_LINES: Final = ("canopen", "sercos")
"""Names of the families whose drives are slaves."""


def slave_of(settings: Settings, axis: str, serial: int) -> SlaveSettings:
    """Return what the line of an axis says of its slave; of one that the rig has on CAN nothing."""
    line = settings.segment[settings.rig.axis[axis].segment]
    if not isinstance(line, SegmentTable):
        return SlaveSettings(serial)
    return SlaveSettings(
        serial,
        start_ns=round(line.of("clock_start_us", axis) * US),
        drift_ppm=line.of("drift_ppm", axis),
        sample_ns=round(line.of("sample_us", axis) * US),
    )


def drive_slave(
    settings: Settings,
    axis: str,
    clock: Scheduler,
    beside: Beside,
    serial: int,
    seed: int,
    entered: Entered | None = None,
) -> EthercatDrive:
    """Make the slave of an axis, of one that the rig has on CAN too.

    Raises UserError for a drive of a family that is not on lines.
    """
    table = settings.rig.drive[settings.rig.axis[axis].drive]
    make = (
        partial(SercosDrive, sercos=table.make())
        if isinstance(table, SercosTable)
        else partial(EthercatDrive, profile=drive_of(settings, axis).make())
    )
    return make(
        name=axis,
        clock=clock,
        axis=beside.axis(axis),
        probes=beside.probes(axis),
        settings=slave_of(settings, axis, serial),
        seed=seed,
        switches=beside.switches(axis),
        entered=None if entered is None else partial(entered, axis),
    )


def terminal_slave(
    settings: Settings,
    segment: str,
    clock: Scheduler,
    beside: Beside,
    advance: Callable[[TimeNs], None],
    serial: int,
) -> StampingTerminal | None:
    """Make the terminal of the PLC, where the rig has it as the last slave of a line."""
    table, line = terminal_on(settings, segment), segment_of(settings, segment)
    if table is None:
        return None
    slave = StampingTerminal(
        clock,
        inputs_of(table, dict(beside.signals)),
        advance,
        serial,
        round(line.of("clock_start_us", TERMINAL) * US),
        line.of("drift_ppm", TERMINAL),
    )
    off_ns = silent_ns(table.silent_from_ms)
    if off_ns is not None:
        clock.call_at(off_ns, Phase.APPLICATION, slave.power_off)
    return slave
