"""Probing signals that columns of a plan give, in a rig without a PLC task.

They act in the NC cycle of their moment, as every column does.
"""

from collections.abc import Collection
from dataclasses import replace
from typing import Final

from axisrig.bench.rig.plc.axis_words import ProbingWrite
from axisrig.kernel.channel import Channel
from axisrig.kernel.parameters.units import UNITS_PER_MM
from axisrig.kernel.plc.probing import PlcTask
from axisrig.kernel.time.clock import Clock, TimeNs

FOREVER_NS: Final = 1 << 62


class ProbingColumns:
    """Writes the units `probing_signal` and `probing_position`; written: what columns write.

    task: what the channel sees of a PLC, None where no column writes a signal.
    """

    def __init__(
        self,
        channel: Channel,
        clock: Clock,
        period_ns: TimeNs,
        written: Collection[ProbingWrite],
    ) -> None:
        self._channel, self._clock = channel, clock
        self.task: PlcTask | None = None
        if written:
            # Nobody runs that could stop, or overrun its cycle
            self.task = PlcTask(
                cycle_ns=period_ns, watchdog_ns=FOREVER_NS, acknowledge_ns=10**10, written_ns=0
            )

    def begin_turn(self) -> None:
        """Say of which SYNC the actual positions of this cycle are."""
        if self.task is not None:
            self.task.sync_ns.update(dict.fromkeys(self._channel.plc.axis, self._channel.sync_ns))

    def write(self, write: ProbingWrite) -> str:
        """Give a unit its value; return what was done, in words."""
        unit = self._channel.plc.axis[write.axis].probing
        writes = unit.writes
        if write.level is not None:
            words = f"probing_signal = {write.level:d}"
            writes = replace(writes, signal=write.level)
        else:
            assert write.position_mm is not None
            words = f"probing_position = {write.position_mm:.15g} mm"
            writes = replace(writes, position_units=round(write.position_mm * UNITS_PER_MM))
        unit.take(writes, self._clock.now_ns)
        return f"{write.axis}.{words} from the PLC"
