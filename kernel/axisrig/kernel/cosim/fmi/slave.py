"""What a co-simulation FMU of any version is to the master: values, steps, saved states, messages.

fmpy reads, checks and instantiates. In the loop its methods cost more than the step itself
(argument arrays are built for every call), so the hot calls go to the same library functions with
argument types set once and buffers allocated once. `fmi2.py` and `fmi3.py` hold what differs.
"""

import ctypes
import math
import os
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, ClassVar, NoReturn

from fmpy.model_description import ModelDescription, ModelVariable

from axisrig.kernel.cosim.fmi.binding import with_signature
from axisrig.kernel.cosim.fmi.journal import watched
from axisrig.kernel.cosim.fmi.library import (
    DISCARD,
    FATAL,
    OK,
    STATUS_WORDS,
    TIME_RESOLUTION_S,
    WARNING,
    Capabilities,
    EndedError,
    FmuState,
    Layout,
    LogMessage,
    Missing,
    PlantError,
    array_type,
    grid_of,
    own_step_s,
    standstill,
)
from axisrig.kernel.cosim.fmi.variable_index import by_name, of_causality
from axisrig.kernel.errors import UserError, nearest, printable
from axisrig.kernel.time.clock import TimeNs, ns_to_seconds, seconds_to_ns

MESSAGES_MAX = 1000
# One call of `step_to` may be answered in that many parts; an FMU that needs more does not advance
PARTS_MAX = 1000
IDLE_RETURNS_MAX = 10

POINTER, SIZE = ctypes.c_void_p, ctypes.c_size_t


class Exchange:
    """A fixed list of variables of one type with its value buffer: `values`, `read`, `write`.

    values: ctypes array in the order of the names (an array variable takes as many places as it
    has elements); FMU units. references: likewise. Raises UserError for types that differ.
    """

    def __init__(self, slave: "FmuSlave", names: Sequence[str]) -> None:
        if not slave.pointer:
            raise PlantError(slave.name, slave.time_ns, "the instance is freed")
        word, kind, count, self.references, self._references = slave.layout(tuple(names))
        self.values: Any = array_type(kind, count)()
        self._slave = slave
        places = [ctypes.addressof(self._references), len(names), ctypes.addressof(self.values)]
        arguments: tuple[Any, ...] = (slave.pointer, *places)
        signature: tuple[Any, ...] = (POINTER, POINTER, SIZE, POINTER)
        if slave.COUNTS_VALUES:
            arguments, signature = (*arguments, count), (*signature, SIZE)
        self._arguments = arguments
        # A library without inputs of a type may well have no function to set them
        self._get = slave.function(f"{slave.PREFIX}Get{word}", signature)
        self._set = slave.function(f"{slave.PREFIX}Set{word}", signature)

    def read(self) -> None:
        """Fill `values` from the FMU."""
        status = self._get(*self._arguments)
        if status > WARNING:
            self._slave.failed("get", status)

    def write(self) -> None:
        """Hand `values` to the FMU."""
        status = self._set(*self._arguments)
        if status > WARNING:
            self._slave.failed("set", status)


# Unpacked folder and model identifier -> instance, of FMUs that exist once per process
_ALONE: dict[tuple[str, str], str] = {}


class FmuSlave(ABC):
    """An instance of a co-simulation FMU with a name of its own.

    path: the FMU file. name: instance name in messages and recordings. messages: what the FMU
    logged with a status above ok, the last 1000. grid_ns: step of an FMU that takes no other; its
    outputs hold between. Raises UserError for an FMU that cannot be used, PlantError once it runs.
    """

    PREFIX: ClassVar[str]
    COUNTS_VALUES: ClassVar[bool]
    TYPES: ClassVar[Mapping[str, tuple[str, Any]]]
    """Type in the description -> word in the names of get and set, ctypes type."""
    STATE_WORD: ClassVar[str]

    problems: tuple[str, ...] = ()
    """Where the model description breaks the standard without being useless."""
    is_own: bool = False
    """Whether this version has built it: its gets and sets are not noted, for they come back."""
    _fmu: Any  # fmpy's slave
    _step: Any  # doStep of the library, and what follows its first four arguments
    _step_tail: tuple[int, ...] = ()
    _cut: Any = ctypes.c_uint16(0)  # FMI 3.0: not 0 when a step of status ok was cut short
    _last_time: Any = ctypes.c_double(math.inf)  # FMI 3.0: where the FMU says that it has come

    def __init__(self, path: Path, name: str, description: ModelDescription, folder: str) -> None:
        self.path, self.name, self.description = path, name, description
        self.can = Capabilities.of(description, Path(folder))
        self.messages: deque[LogMessage] = deque(maxlen=MESSAGES_MAX)
        self.time_ns: TimeNs = 0
        self.pointer = 0
        self._variables = by_name(description)
        self._excess_s = 0.0  # how far before `time_ns` an early return left the FMU
        self.own_step_s = own_step_s(description)
        self.grid_ns = grid_of(description)
        self._stands_ns: TimeNs = 0  # on a grid: the last point that the FMU has reached
        self._can_terminate, self._is_fatal = False, False
        self._states: list[FmuState] = []
        self._retried: FmuState | None = None  # where a discarded step began
        self._is_final = True  # no state was saved yet that could be restored
        self._alone = (folder, str(description.coSimulation.modelIdentifier))
        self._functions: dict[tuple[str, tuple[Any, ...]], Any] = {}
        self._layouts: dict[tuple[str, ...], Layout] = {}
        self._load(folder)
        self.pointer = int(self._fmu.component)
        self._limit_logging()
        if self.can.once_per_process:
            _ALONE[self._alone] = name
        if self.can.can_save_state:
            word = f"{self.PREFIX}%s{self.STATE_WORD}"
            self._save = self.function(word % "Get", (POINTER, POINTER))
            self._restore = self.function(word % "Set", (POINTER, POINTER))
            self._free = self.function(word % "Free", (POINTER, POINTER))

    # What differs between FMI 2.0 and 3.0

    @abstractmethod
    def _instantiate(self, folder: str) -> None:
        """Load the library; `_fmu` then is fmpy's slave with its instance."""

    @abstractmethod
    def _enter_initialization(self, start_s: float) -> None:
        """Go through the initialisation at `start_s`."""

    @abstractmethod
    def _progress(self) -> tuple[float, bool]:
        """Return where a step ended (s; nan: not reported), and whether the FMU ends the run."""

    # Loading

    def _load(self, folder: str) -> None:
        other = _ALONE.get(self._alone)
        if other is not None:
            raise UserError(
                f"the FMU can exist only once in a process and is already plant {other}",
                file=self.path,
                value=self.name,
                hint="use it once in the rig, or a copy of the FMU under another model identifier",
            )
        working_directory = Path.cwd()
        try:
            self._watched("load", self._instantiate)(folder)
        except Exception as error:  # fmpy raises plain Exceptions for a library that does not load
            detail = "; ".join([str(error), *(m.text for m in self.messages)])
            hint = "the FMU needs the tool that made it on this machine"
            raise UserError(
                f"the FMU cannot be loaded: {detail}",
                file=self.path,
                hint=hint if self.can.needs_tool else None,
            ) from error
        finally:
            os.chdir(working_directory)  # fmpy leaves it changed when a library fails to load

    def _limit_logging(self) -> None:
        """Ask for messages about trouble only: each costs a call into Python."""
        wanted = [c.name for c in self.description.logCategories if c.name.startswith("logStatus")]
        if wanted:
            with suppress(Exception):  # all messages then come, which is slow but not wrong
                self._fmu.setDebugLogging(True, wanted)

    def _log(self, status: int, category: bytes | None, message: bytes | None) -> None:
        if status > OK:
            text = printable((message or b"").decode("utf-8", errors="replace").strip())
            word = (category or b"").decode("utf-8", errors="replace")
            self.messages.append(LogMessage(self.time_ns, status, word, text))

    def function(self, name: str, signature: tuple[Any, ...]) -> Any:
        """Return a function of the library, bound once; one that is missing raises UserError."""
        known = self._functions.get((name, signature))
        if known is None:
            known = getattr(self._fmu.dll, name)
            if not isinstance(known, Missing):
                known = self._watched(name, with_signature(known, signature))
            self._functions[name, signature] = known
        return known

    @property
    def fmpy(self) -> Any:
        """fmpy's slave of this instance, for what the loop does not need."""
        return self._fmu

    def _watched(self, name: str, call: Any) -> Any:
        is_sure = self.is_own and name[4:7] in ("Get", "Set")
        return call if is_sure else watched(call, self.path.name, self.name, name, self)

    def _watch(self, fmu: Any) -> None:
        """Let the calls that go through fmpy be noted too."""
        call = fmu._call
        fmu._call = lambda name, *arguments: self._watched(name, call)(name, *arguments)

    # Variables

    def variable(self, name: str) -> ModelVariable:
        """Return the description of a variable; UserError with the nearest names if unknown."""
        if name not in self._variables:
            raise UserError(
                f"FMU {self.path.name} (instance {self.name}) has no such variable",
                value=name,
                allowed=nearest(name, self._variables) or sorted(self._variables),
            )
        return self._variables[name]

    def has(self, *names: str) -> bool:
        """Return whether the FMU has all these variables."""
        return all(name in self._variables for name in names)

    def layout(self, names: tuple[str, ...]) -> Layout:
        """Return how these variables are exchanged; the next machine asks for the same ones."""
        known = self._layouts.get(names)
        if known is None:
            variables = [self.variable(name) for name in names]
            known = self._layouts[names] = Layout.of(variables, self.TYPES, self.path.name)
        return known

    def names(self, causality: str) -> list[str]:
        """Return the names of all variables of one causality, in the order of the description."""
        return [variable.name for variable in of_causality(self.description, causality)]

    def set_start(self, name: str, value: float | bool | str) -> None:
        """Set a parameter or a start value before initialisation, in the FMU's unit."""
        if isinstance(value, str):
            try:
                self._fmu.setString([self.variable(name).valueReference], [value])
            except Exception as error:  # fmpy turns a bad status into a plain Exception
                raise PlantError(self.name, self.time_ns, self._explain(str(error))) from error
            return
        exchange = Exchange(self, [name])
        exchange.values[0] = value
        exchange.write()

    def get(self, name: str) -> float:
        """Read one variable now, in the FMU's unit."""
        exchange = Exchange(self, [name])
        exchange.read()
        return float(exchange.values[0])

    # Time

    def initialize(self, start_ns: TimeNs) -> None:
        """Run the initialisation at `start_ns`."""
        self.time_ns = self._stands_ns = start_ns
        self._excess_s = 0.0
        try:
            self._enter_initialization(ns_to_seconds(start_ns))
            self._can_terminate = True
        except Exception as error:  # fmpy turns a bad status into a plain Exception
            raise PlantError(self.name, start_ns, self._explain(str(error))) from error

    def step_to(self, end_ns: TimeNs) -> None:
        """Advance the FMU to `end_ns`, in parts where it returns early or discards a step.

        Raises PlantError when it fails, ends the simulation, or does not come to `end_ns`.
        """
        if self.step_towards(end_ns) < end_ns:
            for _ in self.parts_to(end_ns):
                self.step_towards(end_ns)

    def parts_to(self, end_ns: TimeNs) -> Iterator[None]:
        """Yield for each step up to `end_ns`; raise PlantError when it never comes there."""
        for _ in range(PARTS_MAX):
            if self.time_ns >= end_ns:
                return
            yield
        if self.time_ns < end_ns:
            self._fail(f"doStep: not at {end_ns / 1e6:.6f} ms after {PARTS_MAX} steps")

    def step_towards(self, end_ns: TimeNs) -> TimeNs:
        """Do one step that shall end at `end_ns`; return the time of the FMU, perhaps earlier.

        Raises PlantError as `step_to` does.
        """
        if self.grid_ns is not None:
            return self._step_on_grid(self.grid_ns, end_ns)
        begin_ns, excess_s = self.time_ns, self._excess_s
        begin_s = begin_ns * 1e-9 + excess_s
        status = self._step(
            self.pointer,
            begin_s,
            (end_ns - begin_ns) * 1e-9 - excess_s,
            self._is_final,
            *self._step_tail,
        )
        if status > WARNING or self._cut.value:
            return self._not_there(status, end_ns)
        if not self._last_time.value > begin_s:
            lack = standstill(self._last_time.value, end_ns * 1e-9, self.own_step_s)
            if lack is not None:
                self._fail(f"doStep: ok, but {lack}")
        self.time_ns, self._excess_s = end_ns, 0.0
        return end_ns

    def _step_on_grid(self, grid_ns: TimeNs, end_ns: TimeNs) -> TimeNs:
        """Do the steps of the FMU that end at `end_ns` at the latest."""
        self.grid_ns, self.time_ns = None, self._stands_ns
        try:
            while self.time_ns + grid_ns <= end_ns:
                self.step_to(self.time_ns + grid_ns)
        finally:
            self.grid_ns, self._stands_ns = grid_ns, self.time_ns
        self.time_ns = end_ns
        return end_ns

    def _not_there(self, status: int, end_ns: TimeNs) -> TimeNs:
        """Go on after a step that did not reach its end: from the time of the FMU.

        An FMU that has discarded the whole step gets half of it, when its state can be saved: only
        setting a state leads out of a discarded step (FMI 2.0.4, 4.2.4).
        """
        step_ns, idle = end_ns - self.time_ns, 0
        begin_s = self.time_ns * 1e-9 + self._excess_s
        while status == DISCARD or (status <= WARNING and self._cut.value):
            last_s, wants_end = self._progress()
            if wants_end:
                self._fail("the FMU ended the simulation", last_s, EndedError)
            if not begin_s - TIME_RESOLUTION_S <= last_s <= end_ns * 1e-9 + TIME_RESOLUTION_S:
                self._fail("doStep: cut short, and the FMU does not say how far it came")
            if last_s > begin_s + TIME_RESOLUTION_S:
                return self._stand_at(last_s, end_ns)
            if status <= WARNING:
                idle += 1
                if idle > IDLE_RETURNS_MAX:
                    self._fail("doStep: the FMU returns early again and again without progress")
            else:
                step_ns //= 2
                self._prepare_retry(step_ns)
            step_s = step_ns * 1e-9 - self._excess_s
            status = self._step(self.pointer, begin_s, step_s, self._is_final, *self._step_tail)
            if status <= WARNING and not self._cut.value:
                return self._stand_at(begin_s + step_s, end_ns)
        self.failed("doStep", status)

    def _prepare_retry(self, step_ns: TimeNs) -> None:
        missing = [
            text
            for text, is_there in (
                ("save its state", self.can.can_save_state),
                ("take steps that differ in length", self.can.can_vary_step),
            )
            if not is_there
        ]
        if missing:
            self._fail(f"doStep: discard without progress, and the FMU cannot {missing[0]}")
        if step_ns < 1:
            self._fail("doStep: the FMU discards every step down to 1 ns")
        self._retried = self.save_state(self._retried)  # one for all: a run may have many of them
        self.restore_state(self._retried)

    def _stand_at(self, time_s: float, end_ns: TimeNs) -> TimeNs:
        self.time_ns = min(seconds_to_ns(time_s), end_ns)
        self._excess_s = time_s - self.time_ns * 1e-9
        if end_ns * 1e-9 - time_s < TIME_RESOLUTION_S:
            self.time_ns, self._excess_s = end_ns, 0.0
        return self.time_ns

    # Saved states

    def save_state(self, into: FmuState | None = None) -> FmuState:
        """Save the whole state now; into: a state of this instance to be overwritten.

        Raises PlantError when the FMU cannot or refuses. `restore_state` may follow any number of
        times.
        """
        if not self.can.can_save_state:
            raise PlantError(self.name, self.time_ns, "the FMU cannot save its state")
        state = into or FmuState()
        if into is None:
            self._states.append(state)
        status = self._save(self.pointer, ctypes.addressof(state.handle))
        if status > WARNING:
            self.failed("save the state", status)
        state.time_ns, state.excess_s = self.time_ns, self._excess_s
        state.stands_ns = self._stands_ns
        self._is_final = False
        return state

    def restore_state(self, state: FmuState) -> None:
        """Go back to a saved state and its time. Raises PlantError when the FMU refuses."""
        status = self._restore(self.pointer, state.handle)
        if status > WARNING:
            self.failed("restore the state", status)
        self.time_ns, self._excess_s = state.time_ns, state.excess_s
        self._stands_ns = state.stands_ns

    # Ends

    def failed(self, what: str, status: int) -> NoReturn:
        """Raise PlantError with the messages that the FMU logged."""
        self._can_terminate = False  # FMI 3.0, 2.3.1: after an error only freeing is allowed
        self._is_fatal = status == FATAL
        self._fail(f"{what}: {STATUS_WORDS.get(status, status)}")

    def _fail(
        self, text: str, time_s: float = math.nan, kind: type[PlantError] = PlantError
    ) -> NoReturn:
        time_ns = seconds_to_ns(time_s) if math.isfinite(time_s) else self.time_ns
        raise kind(self.name, time_ns, self._explain(text))

    def _explain(self, text: str) -> str:
        return "; ".join([text, *(message.text for message in list(self.messages)[-3:])])

    def close(self) -> None:
        """Terminate and free the instance; the library stays loaded for the next one."""
        if not self.pointer:
            return
        if not self._is_fatal:  # after fatal no function may be called any more
            with suppress(Exception):  # a function that is missing or fails: nothing is lost now
                for state in self._states:
                    self._free(self.pointer, ctypes.addressof(state.handle))
                if self._can_terminate:
                    self._fmu.terminate()
            with suppress(Exception):
                getattr(self._fmu, f"{self.PREFIX}FreeInstance")(self._fmu.component)
        self.pointer = 0
        _ALONE.pop(self._alone, None)
