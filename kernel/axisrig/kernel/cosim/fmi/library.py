"""What an FMU promises and says, how it fails, and its library with what it lacks."""

import ctypes
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from fmpy.model_description import ModelDescription, ModelVariable

from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import S, TimeNs


class PlantError(Exception):
    """A plant model failed while running: instance, time and the FMU's own message."""

    def __init__(self, instance: str, time_ns: TimeNs, message: str) -> None:
        super().__init__(f"plant {instance} at t = {time_ns / 1e6:.6f} ms: {message}")
        self.instance, self.time_ns, self.reason = instance, time_ns, message


class EndedError(PlantError):
    """An FMU ended the simulation by itself, as a model may by `terminate`."""


class EdgeMayBeLostError(PlantError):
    """An axis gained speed faster than a probe reckons with: nobody knows whether it has touched.

    No fault of a model: an axis that follows its demand exactly jumps as its demand does.
    """


class FmuState:
    """A saved state of one instance; filled again by saving into it."""

    def __init__(self) -> None:
        self.handle = ctypes.c_void_p()
        self.time_ns: TimeNs = 0
        self.excess_s = 0.0
        self.stands_ns: TimeNs = 0


@dataclass(frozen=True)
class LogMessage:
    """What an FMU said: at which time, with which status (0 ok ... 4 fatal)."""

    time_ns: TimeNs
    status: int
    category: str
    text: str


# FMUs give their time as a sum of floats; less than this is no progress
TIME_RESOLUTION_S = 1e-12
OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
STATUS_WORDS = {
    DISCARD: "discard",
    ERROR: "error",
    FATAL: "fatal",
    PENDING: "pending (asynchronous stepping is not supported)",
}


@dataclass(frozen=True)
class Capabilities:
    """What the model description promises, in the same words for FMI 2.0 and 3.0.

    can_save_state: get, set and free FMU states. can_return_early: `doStep` may end at an event
    inside the step. can_vary_step: steps may differ in length. fixed_step_s: internal step, or the
    longest one of an FMU of axisrig; None when not given.
    """

    can_save_state: bool
    can_serialize_state: bool
    can_return_early: bool
    can_vary_step: bool
    once_per_process: bool
    needs_tool: bool
    fixed_step_s: float | None

    @classmethod
    def of(cls, description: ModelDescription, folder: Path) -> "Capabilities":
        """Read the flags of the co-simulation interface. folder: the unpacked FMU."""
        declared = description.coSimulation
        fixed = declared.fixedInternalStepSize
        step_s = float(fixed) if fixed else None
        if step_s is None and str(description.generationTool or "").startswith("axisrig"):
            step_s = longest_internal_step_s(folder)
        early = declared.mightReturnEarlyFromDoStep  # FMI 3.0 only; False for 2.0
        return cls(
            can_save_state=bool(declared.canGetAndSetFMUstate),
            can_serialize_state=bool(declared.canSerializeFMUstate),
            can_return_early=bool(early),
            can_vary_step=bool(declared.canHandleVariableCommunicationStepSize),
            once_per_process=bool(declared.canBeInstantiatedOnlyOncePerProcess),
            needs_tool=bool(declared.needsExecutionTool),
            fixed_step_s=step_s,
        )


_LONGEST_STEP = re.compile(rb"<(?:\w+:)?LongestInternalStep\s[^>]*?seconds=[\"']([^\"']*)[\"']")


@cache
def longest_internal_step_s(folder: Path) -> float | None:
    """Return the longest internal step of an unpacked FMU of axisrig, s; None when it names none.

    Its solver takes shorter ones where it must, so that `fixedInternalStepSize` would be untrue:
    its own annotation says it (`LongestInternalStep`).
    """
    found = _LONGEST_STEP.search((folder / "modelDescription.xml").read_bytes())
    return float(found[1]) if found is not None else None


def own_step_s(description: ModelDescription) -> float | None:
    """Return the step in which an FMU goes on by itself, s: internal, else that of its experiment.

    None when it gives neither.
    """
    declared, experiment = description.coSimulation, description.defaultExperiment
    step_s = declared.fixedInternalStepSize or (experiment.stepSize if experiment else None)
    return float(step_s) if step_s else None


def standstill(last_s: float, end_s: float, own_step_s: float | None) -> str | None:
    """Say why a step of status ok that should have come to `end_s` has not come there.

    last_s: where it has come by its own account. It may wait for the end of a longer step of its
    own where its description gives this step. None: nothing is wrong.
    """
    if math.isnan(last_s):
        return "where the FMU has come (lastSuccessfulTime) is no number"
    if end_s - last_s > (own_step_s or 0.0) + TIME_RESOLUTION_S:
        return f"the FMU does not advance (lastSuccessfulTime {last_s:.9g} s)"
    return None


def grid_of(description: ModelDescription) -> TimeNs | None:
    """Return the step of an FMU that cannot take steps of different length; None for others.

    An FMU that gives no step of its own gets the steps that the bench takes.
    """
    step_s = own_step_s(description)
    if step_s is None or description.coSimulation.canHandleVariableCommunicationStepSize:
        return None
    return max(round(step_s * S), 1)


@cache
def array_type(kind: Any, count: int) -> Any:
    """Return the ctypes type of so many elements; ctypes would make it anew for every instance."""
    return kind * count


class Layout(NamedTuple):
    """How a list of variables is exchanged, which the model description alone decides.

    word: in the names of get and set. kind: ctypes type of a value. places: that the values take.
    references: of the variables; array: the same for the library.
    """

    word: str
    kind: Any
    places: int
    references: list[int]
    array: Any

    @classmethod
    def of(
        cls,
        variables: Sequence[ModelVariable],
        types: Mapping[str, tuple[str, Any]],
        file: str,
    ) -> "Layout":
        """Make it. types: type in the description -> word and ctypes type. file: of the FMU.

        Raises UserError for types that differ.
        """
        kinds = {types.get(str(variable.type)) for variable in variables}
        kind = kinds.pop() if len(kinds) == 1 else None
        if kind is None:
            raise UserError(
                f"FMU {file}: {', '.join(variable.name for variable in variables)} differ in type"
                " or have one that cannot be exchanged",
                value=" ".join(sorted({str(variable.type) for variable in variables})),
                allowed=types,
            )
        references = [variable.valueReference for variable in variables]
        array = array_type(ctypes.c_uint32, len(references))(*references)
        places = sum(math.prod(variable.shape or ()) for variable in variables)
        return cls(*kind, places, references, array)


class Missing:
    """Replaces a function that a library lacks: loading goes on, calling it reports its name."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __call__(self, *_arguments: object) -> int:
        """Report what is missing."""
        raise UserError(f"the library of the FMU has no function {self.name}")


class Library:
    """A loaded library that answers for functions it lacks, so that fmpy can bind what is there."""

    def __init__(self, dll: Any) -> None:
        self._dll = dll
        self._handle = dll._handle  # fmpy frees the library through it

    def __getattr__(self, name: str) -> Any:
        try:
            return getattr(self._dll, name)
        except AttributeError:
            return Missing(name)
