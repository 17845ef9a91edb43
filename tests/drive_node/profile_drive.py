"""A drive in profile modes, led by SDO without any SYNC.

The axis follows its demand exactly, so 6064 is the demand. Position units are 1/104857.6 mm.
"""

from typing import Any

from axisrig.kernel.time.clock import MS

PER_M = 104_857_600
NEW, AT_ONCE, RELATIVE, HALT = 1 << 4, 1 << 5, 1 << 6, 1 << 8
REACHED, LIMITED, BIT_12 = 1 << 10, 1 << 11, 1 << 12


class Drive:
    """A drive without any SYNC, led by SDO: it must do its profiles on its own ticks."""

    def __init__(self, bench: Any, mode: int, **objects: float) -> None:
        self.bench, self.sdo, self.axis = bench, bench.remote.sdo, bench.axis
        self.acted_ns: list[int] = []
        react = bench.node.servo.react
        bench.node.servo.react = lambda now_ns: (self.acted_ns.append(now_ns), react(now_ns))
        self.sdo[0x6060].raw = mode
        self.set(**objects)
        for word in (0x06, 0x07, 0x0F):
            self.sdo[0x6040].raw = word

    def set(self, **objects: float) -> None:
        for name, value in objects.items():
            index, _, sub = name.removeprefix("o").partition("_")
            entry = self.sdo[int(index, 16)]
            (entry[int(sub)] if sub else entry).raw = round(value)

    def word(self, word: int) -> int:
        """Write the controlword; return when it acted."""
        self.sdo[0x6040].raw = word
        return self.acted_ns[-1]

    @property
    def now_ns(self) -> int:
        return int(self.bench.scheduler.now_ns)

    @property
    def status(self) -> int:
        return int(self.sdo[0x6041].raw)

    def at(self, time_ns: int) -> float:
        """Position in m at an instant."""
        self.bench.scheduler.run_until(time_ns)
        self.axis.advance_to(time_ns)
        return float(self.axis.motor_position_m())

    def run_ms(self, time_ms: float) -> None:
        self.bench.scheduler.run_until(self.now_ns + round(time_ms * MS))


PROFILE = {"o6081": 0.2 * PER_M, "o6083": 2 * PER_M, "o6084": 4 * PER_M}
RATES = (0.2, 2.0, 4.0)
