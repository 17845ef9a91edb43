"""One instance of an FMU on trial: stepped as the bench steps it, all outputs read bit for bit."""

import math
import struct
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from fmpy.model_description import ModelDescription, ModelVariable

from axisrig.kernel.cosim.fmi.fmu import EndedError, FmuSlave, load_fmu
from axisrig.kernel.cosim.fmi.variable_index import of_causality
from axisrig.kernel.time.clock import TimeNs, seconds_to_ns

DEFAULT_STEP_NS: TimeNs = 1_000_000
_REALS = ("Real", "Float64", "Float32")
# Inputs move by this share of their start value, or of 1, so that outputs have something to follow
_MOTION = 1e-3
_PATTERN = (0.0, 1.0, 2.0, 1.0, 0.0, -1.0, -2.0, -1.0)
_DRIFT = 1e-3  # of _MOTION in a step
FLAG_AFTER_STEPS = 10


@dataclass(frozen=True)
class Reading:
    """All outputs at one time. bits: to compare; text: by name, to show."""

    time_ns: TimeNs
    bits: bytes
    values: tuple[Any, ...]


def step_of(description: ModelDescription) -> TimeNs:
    """Return the step that the FMU itself proposes, else 1 ms."""
    experiment = description.defaultExperiment
    fixed = getattr(description.coSimulation, "fixedInternalStepSize", None)
    for proposed_s in (experiment.stepSize if experiment is not None else None, fixed):
        step_s = float(proposed_s) if proposed_s else 0.0
        if math.isfinite(step_s) and step_s >= 1e-9:
            return seconds_to_ns(step_s)
    return DEFAULT_STEP_NS


def readable_outputs(description: ModelDescription) -> list[ModelVariable]:
    """Return the outputs that have a value at every communication point: no clocks, not clocked."""
    return [
        variable
        for variable in of_causality(description, "output")
        if variable.type != "Clock" and not variable.clocks
    ]


class Trial:
    """An instance of an FMU. moves: whether its inputs are moved from step to step.

    drifts: they go on a little besides, so that no two steps have the same value.
    Raises UserError when it cannot be loaded, PlantError once it runs.
    """

    def __init__(
        self, path: Path, name: str = "trial", *, moves: bool = False, drifts: bool = False
    ) -> None:
        self.slave: FmuSlave = load_fmu(path, name)
        self.outputs = readable_outputs(self.slave.description)
        self._inputs = movable_inputs(self.slave.description)
        self._moves = moves
        self._drifts = drifts
        self.count = 0

    def start(self) -> None:
        """Initialise at time 0."""
        self.count = 0
        self.slave.initialize(0)

    def read(self) -> Reading:
        """Read all outputs now."""
        values = tuple(self._value(variable) for variable in self.outputs)
        bits = b"\0".join(_bits(value) for value in values)
        return Reading(self.slave.time_ns, bits, values)

    def _value(self, variable: ModelVariable) -> Any:
        kind = str(variable.type)
        if kind == "Enumeration":
            kind = "Integer" if self.slave.PREFIX == "fmi2" else "Int64"
        get = getattr(self.slave.fmpy, f"get{kind}")
        references = [variable.valueReference]
        count = int(np.prod(variable.shape or ()))
        return tuple(get(references) if count == 1 else get(references, nValues=count))

    def step(self, step_ns: TimeNs) -> Reading:
        """Move the inputs if that is wanted, do one step, read all outputs."""
        if self._moves:
            self._move_inputs()
        self.count += 1
        self.slave.step_to(self.slave.time_ns + step_ns)
        return self.read()

    def run(self, steps: Sequence[TimeNs]) -> list[Reading]:
        """Do steps of these lengths, fewer when the FMU ends the simulation by itself."""
        readings: list[Reading] = []
        with suppress(EndedError):
            for step_ns in steps:
                readings.append(self.step(step_ns))
        return readings

    def course(self, step_ns: TimeNs, span_ns: TimeNs) -> list[Reading]:
        """Do steps of one length over a span; inputs move at whole milliseconds, for any length."""
        readings = [self.read()]
        with suppress(EndedError):
            for _ in range(span_ns // step_ns):
                self.count = self.slave.time_ns // DEFAULT_STEP_NS
                readings.append(self.step(step_ns))
        return readings

    def _move_inputs(self) -> None:
        drift = _DRIFT * self.count if self._drifts else 0.0
        for variable, value in _moved_inputs(self._inputs, self.count, drift):
            setter = getattr(self.slave.fmpy, f"set{variable.type}")
            setter([variable.valueReference], [value])

    def reset(self) -> None:
        """Reset the instance to where it was instantiated."""
        self.slave.fmpy.reset()

    def close(self) -> None:
        """Terminate and free the instance."""
        self.slave.close()


def movable_inputs(description: ModelDescription) -> list[ModelVariable]:
    """Return the inputs that can be moved: single values that wait for no clock."""
    return [
        variable
        for variable in of_causality(description, "input")
        if not variable.shape and not variable.clocks
    ]


def _moved_inputs(
    inputs: Sequence[ModelVariable], count: int, drift: float = 0.0
) -> Iterator[tuple[ModelVariable, float | bool]]:
    for variable in inputs:
        if variable.type in _REALS:
            start = float(variable.start or 0.0)
            swing = _MOTION * max(1.0, abs(start)) * (_PATTERN[count % len(_PATTERN)] + drift)
            low = float(variable.min) if variable.min is not None else -math.inf
            high = float(variable.max) if variable.max is not None else math.inf
            yield variable, min(max(start + swing, low), high)
        elif variable.type == "Boolean":
            start_flag = str(variable.start).strip().lower() in ("true", "1")
            yield variable, start_flag is not (count >= FLAG_AFTER_STEPS)


def _bits(value: tuple[Any, ...]) -> bytes:
    parts = [struct.pack("<d", v) if isinstance(v, float) else repr(v).encode() for v in value]
    return b",".join(parts)


def first_difference(
    one: Sequence[Reading], other: Sequence[Reading], outputs: Sequence[ModelVariable]
) -> str | None:
    """Say where two runs differ first, None when they are equal bit for bit."""
    if len(one) != len(other):
        return f"one ends itself after {len(one)} steps, the other after {len(other)}"
    for a, b in zip(one, other, strict=True):
        if a.bits == b.bits:
            continue
        for variable, left, right in zip(outputs, a.values, b.values, strict=True):
            if _bits(left) != _bits(right):
                shown = f"{_short(left)} and {_short(right)}"
                return f"{variable.name} at t = {a.time_ns / 1e6:g} ms is {shown}"
    return None


def largest_share(
    one: Sequence[Reading], other: Sequence[Reading], outputs: Sequence[ModelVariable]
) -> float:
    """Return the largest difference of two runs as a share of the range of its output.

    The range is the largest amount of the output in both runs. Infinite for what is no number, and
    for runs of other lengths.
    """
    if len(one) != len(other):
        return math.inf
    largest = 0.0
    for at in range(len(outputs)):
        pairs = [
            (left, right)
            for a, b in zip(one, other, strict=True)
            for left, right in zip(a.values[at], b.values[at], strict=True)
        ]
        if all(_bits((left,)) == _bits((right,)) for left, right in pairs):
            continue
        if not all(isinstance(value, float) and math.isfinite(value) for p in pairs for value in p):
            return math.inf
        span = max(abs(value) for pair in pairs for value in pair)
        largest = max(largest, *(abs(left - right) / (span or 1.0) for left, right in pairs))
    return largest


def _short(value: tuple[Any, ...]) -> str:
    text = ", ".join(repr(v) for v in value)
    return text if len(text) <= 60 else f"{text[:60]}..."


def not_finite(reading: Reading, outputs: Sequence[ModelVariable]) -> list[str]:
    """Return the names of the outputs that are no finite number."""
    return [
        variable.name
        for variable, value in zip(outputs, reading.values, strict=True)
        if any(isinstance(v, float) and not math.isfinite(v) for v in value)
    ]
