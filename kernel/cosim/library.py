"""What an FMU promises and says, and its library with what it lacks."""

from dataclasses import dataclass
from typing import Any

from fmpy.model_description import ModelDescription

from kernel.clock import S, TimeNs
from kernel.errors import UserError


@dataclass(frozen=True)
class LogMessage:
    """What an FMU said: at which time, with which status (0 ok ... 4 fatal)."""

    time_ns: TimeNs
    status: int
    category: str
    text: str


@dataclass(frozen=True)
class Capabilities:
    """What the model description promises, in the same words for FMI 2.0 and 3.0.

    can_save_state: get, set and free FMU states. can_return_early: `doStep` may end at an event
    inside the step. can_vary_step: steps may differ in length. fixed_step_s: internal step, None
    when not told.
    """

    can_save_state: bool
    can_serialize_state: bool
    can_return_early: bool
    can_vary_step: bool
    once_per_process: bool
    needs_tool: bool
    fixed_step_s: float | None

    @classmethod
    def of(cls, description: ModelDescription) -> "Capabilities":
        """Read the flags of the co-simulation interface."""
        told = description.coSimulation
        early = told.mightReturnEarlyFromDoStep  # FMI 3.0 only; False for 2.0
        return cls(
            can_save_state=bool(told.canGetAndSetFMUstate),
            can_serialize_state=bool(told.canSerializeFMUstate),
            can_return_early=bool(early),
            can_vary_step=bool(told.canHandleVariableCommunicationStepSize),
            once_per_process=bool(told.canBeInstantiatedOnlyOncePerProcess),
            needs_tool=bool(told.needsExecutionTool),
            fixed_step_s=float(told.fixedInternalStepSize) if told.fixedInternalStepSize else None,
        )


def grid_of(description: ModelDescription) -> TimeNs | None:
    """Return the step of an FMU that cannot take steps of different length; None for others.

    It is its internal step (FMI 3.0), else the step of its default experiment; an FMU that tells
    neither gets the steps that the bench takes.
    """
    told, experiment = description.coSimulation, description.defaultExperiment
    if told.canHandleVariableCommunicationStepSize:
        return None
    step_s = told.fixedInternalStepSize or (experiment.stepSize if experiment else None)
    return max(round(float(step_s) * S), 1) if step_s else None


class Missing:
    """Stands for a function that a library lacks: loading goes on, calling it tells its name."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __call__(self, *_arguments: object) -> int:
        """Tell what is missing."""
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
