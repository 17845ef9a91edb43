"""A PLC task beside a CNC by hand: two axes, each with its own commands and its own state.

NC cycles at 600 us of each ms. What the program does in its cycles is a function of the test.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from axisrig.bench.machine.plc.hli import Hli, Inputs
from axisrig.bench.machine.plc.task import PlcTaskRunner
from axisrig.bench.machine.wiring.plc import TaskFault
from axisrig.bench.rig.reading.plc_task import PlcTaskTable
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcInterface
from axisrig.kernel.time.clock import MS, US, Phase
from axisrig.kernel.time.scheduler import new_scheduler

Script = Callable[[Inputs, Hli], None]
PROGRAM = "class Program:\n    probe_on = False\n    def cycle(self, inputs, hli):\n        pass\n"


class Carrier:
    """Where positions are sampled so long before the SYNC; clocks: how far they are off."""

    def __init__(self, age_ns: int, limit_ns: int | None, off_ns: int) -> None:
        self._age_ns, self._limit_ns, self.off_ns = age_ns, limit_ns, off_ns

    def sampled_ns(self, _axis: str, sync_ns: int) -> int:
        return sync_ns - self._age_ns

    def clock_limit_ns(self, _axis: str) -> int | None:
        return self._limit_ns

    def clocks_off_ns(self, _axis: str) -> int:
        return self.off_ns


class Link:
    """An axis as its drive reports it."""

    def __init__(self, name: str, actual_mm: float, inputs: int | None) -> None:
        self.name, self.actual_mm, self.digital_inputs = name, actual_mm, inputs


class Cnc:
    """The CNC side; cycles: instant (ms) and number of each cycle of the PLC.

    terminal: its inputs, None without.
    """

    def __init__(
        self, folder: Path, *, has_columns: bool = False, terminal: Any = None, **keys: Any
    ) -> None:
        self.clock = new_scheduler()
        self.plc = PlcInterface(self.clock, ("X", "Z"))
        self.actuated, self.measuring, self.measured, self.beside = (set[str]() for _ in range(4))
        self.links = [Link("X", 1.25003, None), Link("Z", -2.49997, 1 << 16)]
        self.state = SimpleNamespace(name="RUNNING")
        self.timing = SimpleNamespace(period_ns=MS)
        self.sync_ns = 0
        self.observers: list[Callable[[Any], None]] = []
        self.measurement = SimpleNamespace(
            is_actuated=self.actuated.__contains__,
            state_of=lambda name: "ARMED" if name in self.measuring else None,
            measured_acs_mm=lambda name: 1.0 if name in self.measured else None,
        )
        self.single = SimpleNamespace(
            measuring_state=lambda name: "ARMED" if name in self.beside else None
        )
        path = folder / "plc.py"
        path.write_text(PROGRAM, encoding="utf-8")
        self.fault = TaskFault(self.clock)
        self.switched: list[bool] = []
        self.starts = 0
        self.carriers = {"X": Carrier(0, None, 0), "Z": Carrier(125 * US, 700, 90)}
        table = PlcTaskTable.model_validate({"period_us": 2000, "program": str(path), **keys})
        self.runner = PlcTaskRunner(
            table,
            self,  # type: ignore[arg-type]
            self.clock,
            terminal=terminal,
            program=self._program,
            switch=self.switched.append,
            carriers=self.carriers,
            has_columns=has_columns,
            trouble=self.fault,
        )
        self.cycles: list[tuple[float, int]] = []
        self.script: Script = lambda _inputs, _hli: None
        self.runner._program._cycle = self._run
        self.columns: Callable[[], None] = lambda: None
        self.held: list[str] = []
        """What was held in each NC cycle: P = the path, else the names of axes."""
        self.clock.call_at(600 * US, Phase.APPLICATION, self._cycle)

    def _program(self) -> Iterator[canon.Command]:
        self.starts += 1
        return iter(())

    def _run(self, inputs: Inputs, hli: Hli) -> None:
        self.cycles.append((inputs.time_ns / MS, inputs.cycle))
        self.script(inputs, hli)

    def _cycle(self) -> None:
        """One NC cycle: columns, the turn of the PLC, what the PLC may read of it."""
        self.clock.call_at(self.clock.now_ns + MS, Phase.APPLICATION, self._cycle)
        self.sync_ns = self.clock.now_ns // MS * MS
        self.columns()
        self.plc.take_turn()
        held = "P" * self.plc.feedhold
        held += "".join(name for name, unit in self.plc.axis.items() if unit.feedhold)
        self.held.append(held)
        for observer in self.observers:
            observer(self)

    def run(self, until_ms: float, script: Script | None = None) -> "Cnc":
        if script is not None:
            self.script = script
        self.clock.run_until(round(until_ms * MS))
        return self

    def overrides(self) -> tuple[int, int, int]:
        x, z = self.plc.axis.values()
        return self.plc.override_permille, x.override_permille, z.override_permille
