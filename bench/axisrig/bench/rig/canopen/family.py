"""CANopen drives on CAN, as a rig asks for them."""

import math

from axisrig.bench.rig.canopen.arrival import describe_arrival, terminal_grid
from axisrig.bench.rig.canopen.checks import check_drives, check_nodes
from axisrig.bench.rig.canopen.eds_words import eds_warnings
from axisrig.bench.rig.canopen.latches import describe_latches, describe_places
from axisrig.bench.rig.canopen.loop import describe_loop
from axisrig.bench.rig.canopen.members import can_axes, drive_of, segment_of
from axisrig.bench.rig.canopen.schedule import axis_telegrams, describe_schedules
from axisrig.bench.rig.families import RigFamily, SecondEncoder, TerminalGrid
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.mapping import Telegram
from axisrig.kernel.time.clock import US


class CanopenOnCan(RigFamily):
    """CANopen drives on CAN buses."""

    fault_rooms = ("frames", "drives")
    has_objects = True

    def check_addresses(self, settings: Settings) -> None:
        """Check node ids. Raises UserError with file, line and key of the rig."""
        check_nodes(settings)

    def check(self, settings: Settings) -> None:
        """Check objects, latches, start-up and the cycle of each bus.

        Raises UserError with file, line and key of the rig.
        """
        check_drives(settings)

    def describe(self, settings: Settings) -> list[str]:
        """Say where position loops are closed, how latches are proved, how late their status is."""
        loops = [line for name in can_axes(settings) for line in describe_loop(settings, name, 0)]
        return [
            *loops,
            *describe_latches(settings),
            *describe_places(settings),
            *describe_arrival(settings),
        ]

    def warn(self, settings: Settings) -> list[str]:
        """Say what EDS and DCF have against the rig."""
        return eds_warnings(settings)

    def second_encoder(self, settings: Settings, axis: str) -> SecondEncoder | None:
        """Return how 60E4:1 of an axis comes, None where no TPDO carries it."""
        telegram, period_us = _second_telegram(settings, axis), settings.rig.cycle.period_us
        if telegram is None:
            return None
        return SecondEncoder(
            f"60E4:1, {telegram.name} {_comes(telegram)}",
            _every(telegram, period_us),
            telegram.promised_ns(period_us * US),
        )

    def terminal_grid(self, settings: Settings) -> TerminalGrid | None:
        """Return the instants of the node that is the terminal of the PLC."""
        return terminal_grid(settings)

    def tables(self, settings: Settings) -> list[str]:
        """Show the arithmetic of every bus."""
        return describe_schedules(settings)

    def outside(self, settings: Settings, axis: str) -> str:
        """Say where the real drive of an axis is, and what of its scaling nobody checks."""
        table, keys = (
            segment_of(settings, settings.rig.axis[axis].segment),
            drive_of(settings, axis),
        )
        where = f"{table.interface} {table.channel if table.channel is not None else ''}".strip()
        made = keys.make()
        if not keys.scaling_check:
            checked = "NOT compared with the drive"
        elif keys.position_unit_um is None:
            checked = "the lead is NOT compared with the drive"
        else:
            checked = "compared with the drive at its start"
        return (
            f"drive with node {settings.rig.axis[axis].node} on {where};"
            f" encoder {made.encoder_increments} increments per revolution,"
            f" lead {keys.lead_mm:g} mm,"
            f" {float(made.units_per_mm):.10g} position units per mm ({checked})"
        )


def _second_telegram(settings: Settings, name: str) -> Telegram | None:
    """Return the TPDO of an axis that carries 60E4:1."""
    for telegram in axis_telegrams(settings, name).values():
        if any(mapped.field == "second" for mapped in telegram.objects):
            return telegram
    return None


def _comes(telegram: Telegram) -> str:
    if not telegram.is_cyclic:
        timer = f", every {telegram.event_ms} ms at least" if telegram.event_ms else ""
        return f"when it changes{timer}"
    number = telegram.transmission
    return "with every SYNC" if number == 1 else f"with every {number}. SYNC"


def _every(telegram: Telegram, period_us: int) -> int:
    if telegram.is_cyclic:
        return telegram.transmission
    return max(1, math.ceil(telegram.inhibit_100us * 100 / period_us))


FAMILY = CanopenOnCan()
