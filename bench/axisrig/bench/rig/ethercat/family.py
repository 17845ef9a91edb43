"""Drives on EtherCAT as a rig asks for them: CiA 402 and SERCOS."""

from axisrig.bench.rig.ethercat.checks import check_lines
from axisrig.bench.rig.ethercat.members import (
    ec_axes,
    ec_segments,
    segment_of,
    terminal_on,
)
from axisrig.bench.rig.ethercat.on_line import axis_pdos, on_line
from axisrig.bench.rig.ethercat.schedule import schedule_of
from axisrig.bench.rig.ethercat.timing import phases_of
from axisrig.bench.rig.families import RigFamily, SecondEncoder, TerminalGrid
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.time.clock import US


class OnEthercat(RigFamily):
    """Drives on EtherCAT lines."""

    fault_rooms = ("lines", "drives", "idents")
    has_objects = True

    def check(self, settings: Settings) -> None:
        """Check keys, objects, latches and the cycle of each line.

        Raises UserError with file, line and key of the rig.
        """
        check_lines(settings)

    def describe(self, settings: Settings) -> list[str]:
        """Say how latches are proved, and when values act and are seen."""
        lines = []
        for name in ec_axes(settings):
            late_cycles = phases_of(settings, name).late_cycles
            lines += on_line(settings, name).describe(settings, name, late_cycles)
            lines += _times(settings, name)
        return lines

    def second_encoder(self, settings: Settings, axis: str) -> SecondEncoder | None:
        """Return how 60E4:1 of an axis comes, None where no PDO carries it."""
        _, inputs = axis_pdos(settings, axis)
        if not any(mapped.field == "second" for mapped in inputs.objects):
            return None
        period_ns = settings.rig.cycle.period_us * US
        return SecondEncoder(on_line(settings, axis).second, 1, period_ns)

    def late_cycles(self, settings: Settings, axis: str) -> int:
        """Return by how many cycles more than 2 an NC cycle sees what its set values do."""
        return phases_of(settings, axis).late_cycles

    def fresh_late_cycles(self, settings: Settings, axis: str) -> int:
        """Return the same of what the PLC reads as it was at the last SYNC0."""
        return phases_of(settings, axis).fresh_late_cycles

    def terminal_grid(self, settings: Settings) -> TerminalGrid | None:
        """Return when frames pass the terminal of the PLC and are back, where it is on a line."""
        for name in ec_segments(settings):
            if terminal_on(settings, name) is not None:
                cycle = schedule_of(settings, name)
                return TerminalGrid(
                    cycle.period_ns,
                    (cycle.frame_ns + cycle.there_ns) % cycle.period_ns,
                    cycle.back_ns - cycle.there_ns,
                )
        return None

    def tables(self, settings: Settings) -> list[str]:
        """Show the arithmetic of every line."""
        return [
            f"segment {name}, EtherCAT, one cycle\n{schedule_of(settings, name).table()}"
            for name in ec_segments(settings)
        ]


def _times(settings: Settings, name: str) -> list[str]:
    """Say when set values act and when positions are sampled."""
    table = segment_of(settings, settings.rig.axis[name].segment)
    phases = phases_of(settings, name)
    clock = "SYNC0" if table.dc else "the outputs"
    after = phases.late_cycles
    more = "as on CAN" if not after else f"{after} cycle{'s' if after > 1 else ''} more than on CAN"
    return [
        f"axis {name}: frame at {phases.frame_ns / US:g} us, {clock} at {phases.sync_ns / US:g} us,"
        f" positions sampled at {phases.sample_ns / US:g} us of the cycle",
        f"  what an NC cycle sends is seen {phases.way} cycles later, {more}",
    ]


FAMILY = OnEthercat()
