"""FMI 3.0 co-simulation: types, instantiation and the step. Event mode is not used."""

import ctypes
import math
from collections.abc import Mapping
from typing import Any, ClassVar

from fmpy.fmi3 import FMU3Slave

from axisrig.kernel.cosim.fmi.binding import Functions
from axisrig.kernel.cosim.fmi.library import Library
from axisrig.kernel.cosim.fmi.slave import POINTER, FmuSlave

_INTEGERS = ("Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")
_STEP_SIGNATURE = (
    POINTER,
    ctypes.c_double,
    ctypes.c_double,
    ctypes.c_bool,
    POINTER,
    POINTER,
    POINTER,
    POINTER,
)


class FMU3Loaded(FMU3Slave):  # type: ignore[misc]
    """fmpy's slave, which binds functions when they are called, and may lack some."""

    dll: Any

    def _loadFunctions(self) -> None:  # noqa: N802
        self.dll = Library(self.dll)
        self._functions = Functions(type(self), self.dll)


class Fmi3Slave(FmuSlave):
    """An instance of an FMI 3.0 co-simulation FMU; it may return early where it offers to."""

    PREFIX = "fmi3"
    COUNTS_VALUES = True
    STATE_WORD = "FMUState"
    TYPES: ClassVar[Mapping[str, tuple[str, Any]]] = {
        "Float64": ("Float64", ctypes.c_double),
        "Float32": ("Float32", ctypes.c_float),
        **{word: (word, getattr(ctypes, f"c_{word.lower()}")) for word in _INTEGERS},
        "Enumeration": ("Int64", ctypes.c_int64),
        "Boolean": ("Boolean", ctypes.c_bool),
    }

    def _instantiate(self, folder: str) -> None:
        fmu = FMU3Loaded(
            instanceName=self.name,
            guid=self.description.instantiationToken,
            unzipDirectory=folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
        )
        self._watch(fmu)
        fmu.instantiate(
            loggingOn=True,
            earlyReturnAllowed=self.can.can_return_early,
            logMessage=lambda _environment, *message: self._log(*message),
        )
        self._flags = (ctypes.c_bool * 3)()  # event needed, terminate, early return
        self._cut = ctypes.c_uint16.from_buffer(self._flags, 1)
        self._last_time = ctypes.c_double()
        base = ctypes.addressof(self._flags)
        self._step_tail = (base, base + 1, base + 2, ctypes.addressof(self._last_time))
        self._fmu = fmu
        self._step = self.function("fmi3DoStep", _STEP_SIGNATURE)

    def _enter_initialization(self, start_s: float) -> None:
        self._fmu.enterInitializationMode(startTime=start_s)
        self._fmu.exitInitializationMode()

    def _progress(self) -> tuple[float, bool]:
        last_s = self._last_time.value
        return (last_s if math.isfinite(last_s) else math.nan), bool(self._flags[1])
