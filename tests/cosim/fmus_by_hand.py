"""FMUs made by hand: variables by their roles, what is written and each step noted."""

import ctypes
from types import SimpleNamespace
from typing import Any

from axisrig.kernel.cosim.plant.axis import PlantAxis

RAMP = ("reference_position", "reference_velocity", "reference_time", "reference_end")
GROUPS = {
    "ramp": RAMP, "control": ("control", "reference_acceleration", "reference_force"),
    "force_limits": ("force_limit_negative", "force_limit_positive"),
    "force_limit": ("force_limit",), "trajectory": ("step_time",), "tool": ("tilt",),
}  # fmt: skip


class Fmu:
    """An FMU with variables by their roles; what it reports is a function of its time."""

    def __init__(self, *inputs: str, grid_ns: int | None = None, **outputs: Any) -> None:
        self.name, self.grid_ns, self.time_ns = "axis_x", grid_ns, 0
        self.inputs = dict.fromkeys(inputs, 0.0)
        self.outputs = outputs
        self.written: list[tuple[int, dict[str, float]]] = []
        self.steps: list[int] = []
        self.roles: Any = SimpleNamespace(
            slave=self, has=self._has, has_group=self._has_group,
            exchange=lambda names: Values(self, tuple(names)),
            bound={name: SimpleNamespace(variable=f"table.{name}") for name in outputs},
        )  # fmt: skip

    def _has(self, *roles: str) -> bool:
        return all(role in self.inputs or role in self.outputs for role in roles)

    def _has_group(self, group: str) -> bool:
        return self._has(*GROUPS[group])

    def initialize(self, start_ns: int) -> None:
        self.time_ns = start_ns

    def step_to(self, end_ns: int) -> None:
        self.steps.append(end_ns)
        self.time_ns = end_ns

    def save_state(self, _into: Any) -> int:
        return self.time_ns

    def restore_state(self, state: int) -> None:
        self.time_ns = state

    def value(self, name: str) -> float:
        found = self.outputs.get(name, 0.0)
        return float(found(self.time_ns) if callable(found) else found)


class Values:
    """Some variables of an FMU."""

    def __init__(self, fmu: Fmu, names: tuple[str, ...]) -> None:
        self._fmu, self._names = fmu, names
        self.values: Any = (ctypes.c_double * len(names))()

    def read(self) -> None:
        self.values[:] = [self._fmu.value(name) for name in self._names]

    def write(self) -> None:
        new = dict(zip(self._names, self.values, strict=True))
        self._fmu.inputs |= new
        self._fmu.written.append((self._fmu.time_ns, new))


def axis_of(fmu: Fmu) -> PlantAxis:
    axis = PlantAxis(fmu.roles, lambda _ns: None)
    axis.start(0)
    return axis
