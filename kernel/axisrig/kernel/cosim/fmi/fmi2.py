"""FMI 2.0 co-simulation: types, instantiation, log messages and the step."""

import ctypes
import math
from collections.abc import Mapping
from itertools import count
from typing import Any, ClassVar
from weakref import WeakValueDictionary

import fmpy
from fmpy import fmi2
from fmpy.logging import addLoggerProxy

from axisrig.kernel.cosim.fmi.binding import Functions
from axisrig.kernel.cosim.fmi.library import Library
from axisrig.kernel.cosim.fmi.slave import POINTER, FmuSlave

_LAST_SUCCESSFUL_TIME, _TERMINATED = 2, 3  # fmi2StatusKind

# fmpy's proxy fills in the arguments of printf-like messages and hands them to one function for the
# whole process: the environment says which instance speaks.
_SPEAKERS: "WeakValueDictionary[int, Fmi2Slave]" = WeakValueDictionary()
_NUMBERS = count(1)


def _dispatch(
    environment: int | None, _name: bytes, status: int, category: bytes, message: bytes
) -> None:
    speaker = _SPEAKERS.get(environment or 0)
    if speaker is not None:
        speaker._log(status, category, message)


_LOGGER = fmi2.fmi2CallbackLoggerTYPE(_dispatch)


def _native(kind: Any, function: Any) -> Any:
    """Return a C function as a callback, without the way through Python."""
    return kind(ctypes.cast(function, ctypes.c_void_p).value)


class FMU2Loaded(fmi2.FMU2Slave):  # type: ignore[misc]
    """fmpy's slave, which binds functions when they are called, and may lack some."""

    dll: Any

    def _loadFunctions(self) -> None:  # noqa: N802
        self.dll = Library(self.dll)
        self._functions = Functions(type(self), self.dll)


class Fmi2Slave(FmuSlave):
    """An instance of an FMI 2.0 co-simulation FMU."""

    PREFIX = "fmi2"
    COUNTS_VALUES = False
    STATE_WORD = "FMUstate"
    TYPES: ClassVar[Mapping[str, tuple[str, Any]]] = {
        "Real": ("Real", ctypes.c_double),
        "Integer": ("Integer", ctypes.c_int32),
        "Enumeration": ("Integer", ctypes.c_int32),
        "Boolean": ("Boolean", ctypes.c_int32),
    }

    def _instantiate(self, folder: str) -> None:
        fmu = FMU2Loaded(
            instanceName=self.name,
            guid=self.description.guid,
            unzipDirectory=folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )
        self._watch(fmu)
        callbacks = fmi2.fmi2CallbackFunctions()
        callbacks.logger = _LOGGER
        callbacks.allocateMemory = _native(fmi2.fmi2CallbackAllocateMemoryTYPE, fmpy.calloc)
        callbacks.freeMemory = _native(fmi2.fmi2CallbackFreeMemoryTYPE, fmpy.free)
        callbacks.componentEnvironment = number = next(_NUMBERS)
        addLoggerProxy(ctypes.byref(callbacks))
        _SPEAKERS[number] = self
        fmu.instantiate(callbacks=callbacks, loggingOn=True)
        self._fmu = fmu
        kind = (POINTER, ctypes.c_double, ctypes.c_double, ctypes.c_int)
        self._step = self.function("fmi2DoStep", kind)

    def _enter_initialization(self, start_s: float) -> None:
        self._fmu.setupExperiment(startTime=start_s)
        self._fmu.enterInitializationMode()
        self._fmu.exitInitializationMode()

    def _progress(self) -> tuple[float, bool]:
        last_s, wants_end = ctypes.c_double(math.nan), ctypes.c_int(0)
        call = (self._fmu.fmi2GetRealStatus, self._fmu.fmi2GetBooleanStatus)
        try:
            call[1](self._fmu.component, _TERMINATED, ctypes.byref(wants_end))
            call[0](self._fmu.component, _LAST_SUCCESSFUL_TIME, ctypes.byref(last_s))
        except Exception:  # refused or not in the library: then nothing is reported
            return math.nan, bool(wants_end.value)
        return last_s.value, bool(wants_end.value)
