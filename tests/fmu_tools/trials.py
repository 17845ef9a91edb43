"""Trials of an FMU without an FMU: outputs follow the number of steps."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from axisrig.bench.tools.fmu.stepped_instance import Reading
from axisrig.kernel.cosim.fmi.fmu import PlantError


class Slave(SimpleNamespace):
    """An instance."""


class FakeTrial:
    """Outputs follow the inputs, which move with each step; `odd` is added; `prepare` gets the
    instance when made. A state has outputs and time; where its inputs are is of the trial.
    """

    made: list[str]
    outputs: Any = (SimpleNamespace(name="x"),)

    def __init__(self, _path: Path, name: str = "trial", *, moves: bool = False) -> None:
        type(self).made.append(name)
        self.name, self.count, self.moves = name, 0, moves
        self.slave: Any = Slave(
            description=None, can=self.can, messages=list(self.messages), time_ns=0,
            save_state=lambda: Slave(handle=1, time_ns=self.slave.time_ns),
            restore_state=self._restore, fmpy=None,
        )  # fmt: skip
        self.prepare(self)

    can: Any = None
    messages: Any = ()
    ends_after = 10**6
    refuses_ns: Any = ()
    odd: Any = staticmethod(lambda trial, count: 0.0)
    prepare: Any = staticmethod(lambda trial: None)
    restores = 0

    def start(self) -> None:
        self.slave.time_ns = self.count = 0

    def close(self) -> None: ...

    def reset(self) -> None:
        self.was_reset = True

    def _restore(self, saved: Any) -> None:
        self.slave.time_ns = saved.time_ns
        self.restores += 1

    def read(self) -> Reading:
        value = (float(self.count) + self.odd(self, self.count),)
        return Reading(self.slave.time_ns, repr(value).encode(), (value,))

    def run(self, lengths: Any) -> list[Reading]:
        found = []
        for step_ns in lengths:
            if step_ns in self.refuses_ns:
                raise PlantError(self.name, self.slave.time_ns, "no such step")
            if self.count >= self.ends_after:
                break
            self.count += 1
            self.slave.time_ns += step_ns
            found.append(self.read())
        return found


CAN: dict[str, Any] = {"can_save_state": True, "can_serialize_state": False, "can_vary_step": True,
       "once_per_process": False, "fixed_step_s": None}  # fmt: skip
