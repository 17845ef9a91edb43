"""One FMI 3.0 co-simulation FMU, loaded by fmpy and stepped through the pointers fmpy resolved.

fmpy reads, checks, unpacks and instantiates. In the loop its methods cost more than the step
itself (argument arrays are built for every call), so the hot calls go to the same library
functions with argument types set once and buffers allocated once.
"""

import atexit
import ctypes
import os
import shutil
import tempfile
import zipfile
import zlib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
from fmpy.fmi3 import FMU3Slave
from fmpy.model_description import ModelDescription, ModelVariable

from kernel.clock import TimeNs, ns_to_seconds
from kernel.errors import UserError, nearest

FMI_OK, FMI_WARNING = 0, 1

_CTYPES: dict[str, Any] = {
    "Float64": ctypes.c_double,
    "Int32": ctypes.c_int32,
    "Boolean": ctypes.c_bool,
}


class PlantError(Exception):
    """A plant model failed while running: instance, time and the FMU's own message."""

    def __init__(self, instance: str, time_ns: TimeNs, message: str) -> None:
        super().__init__(f"plant {instance} at t = {time_ns / 1e6:.6f} ms: {message}")
        self.instance, self.time_ns, self.reason = instance, time_ns, message


@cache
def _unpacked(path: Path, _stamp: tuple[int, int]) -> tuple[ModelDescription, str]:
    """Read and unpack an FMU once per process; the folder goes when the process ends."""
    folder = tempfile.mkdtemp(prefix="axisrig-fmu-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    description = fmpy.read_model_description(str(path))
    fmpy.extract(str(path), folder)
    return description, folder


def load_description(path: Path) -> tuple[ModelDescription, str]:
    """Return the model description and the unpacked folder of the FMU at `path`.

    Raises UserError when the file is missing, is no FMU, or cannot be used here: other FMI version,
    no co-simulation, no binary for this platform.
    """
    if not path.is_file():
        raise UserError("FMU not found", file=path)
    stamp = path.stat()
    try:
        description, folder = _unpacked(path, (stamp.st_mtime_ns, stamp.st_size))
    except zlib.error as error:
        raise UserError("the FMU is damaged: it cannot be unpacked", file=path) from error
    except (zipfile.BadZipFile, KeyError, AttributeError) as error:
        raise UserError(
            "this is no FMU (a zip archive with modelDescription.xml)", file=path
        ) from error
    except Exception as error:  # fmpy reports a rejected description with plain Exceptions
        raise UserError(f"the model description is rejected: {error}", file=path) from error
    version = str(description.fmiVersion)
    if not version.startswith("3."):
        raise UserError("FMI version not supported here", file=path, value=version, allowed="3.0")
    if description.coSimulation is None:
        raise UserError("the FMU has no co-simulation interface", file=path)
    binaries = Path(folder) / "binaries"
    present = sorted(p.name for p in binaries.iterdir()) if binaries.is_dir() else []
    if fmpy.platform_tuple not in present:
        raise UserError(
            f"the FMU has no binary for this platform ({fmpy.platform_tuple})",
            file=path,
            value=" ".join(present) or "none",
            hint="build the FMU for this platform",
        )
    return description, folder


class Exchange:
    """A fixed list of variables of one type with its value buffer: `values`, `read`, `write`.

    values: ctypes array, shape (len(names),), in the order of the names; FMU units.
    """

    def __init__(self, slave: "FmuSlave", names: Sequence[str]) -> None:
        if not slave.pointer:
            raise PlantError(slave.name, slave.time_ns, "the instance is freed")
        variables = [slave.variable(name) for name in names]
        kinds = {str(v.type) for v in variables}
        if len(kinds) != 1 or not kinds <= set(_CTYPES):
            raise UserError(
                f"FMU {slave.path.name}: {', '.join(names)} differ in type or have one "
                f"that cannot be exchanged",
                value=" ".join(sorted(kinds)),
                allowed=_CTYPES,
            )
        kind = kinds.pop()
        self.values: Any = (_CTYPES[kind] * len(names))()
        self._references = (ctypes.c_uint32 * len(names))(*(v.valueReference for v in variables))
        self._count = len(names)
        self._slave = slave
        arguments = (
            slave.pointer,
            ctypes.addressof(self._references),
            self._count,
            ctypes.addressof(self.values),
            self._count,
        )
        self._arguments = arguments
        self._get = slave.function(f"fmi3Get{kind}", _VALUE_SIGNATURE)
        self._set = slave.function(f"fmi3Set{kind}", _VALUE_SIGNATURE)

    def read(self) -> None:
        """Fill `values` from the FMU."""
        status = self._get(*self._arguments)
        if status > FMI_WARNING:
            self._slave.failed("get", status)

    def write(self) -> None:
        """Hand `values` to the FMU."""
        status = self._set(*self._arguments)
        if status > FMI_WARNING:
            self._slave.failed("set", status)


_POINTER, _SIZE = ctypes.c_void_p, ctypes.c_size_t
_VALUE_SIGNATURE = (_POINTER, _POINTER, _SIZE, _POINTER, _SIZE)
_STEP_SIGNATURE = (
    _POINTER,
    ctypes.c_double,
    ctypes.c_double,
    ctypes.c_bool,
    _POINTER,
    _POINTER,
    _POINTER,
    _POINTER,
)


class FmuSlave:
    """An instance of a co-simulation FMU with a name of its own.

    path: the FMU file. name: instance name in messages and recordings.
    Raises UserError for an FMU that cannot be used, PlantError once it runs.
    """

    def __init__(self, path: Path, name: str) -> None:
        self.path, self.name = path, name
        self.description, folder = load_description(path)
        self._variables = {v.name: v for v in self.description.modelVariables}
        self._messages: list[str] = []
        self.time_ns: TimeNs = 0
        self._can_terminate = False
        working_directory = Path.cwd()
        try:
            self._slave = FMU3Slave(
                instanceName=name,
                guid=self.description.instantiationToken,
                unzipDirectory=folder,
                modelIdentifier=self.description.coSimulation.modelIdentifier,
            )
            self._slave.instantiate(loggingOn=True, logMessage=self._log)
        except Exception as error:  # fmpy raises plain Exceptions for a library that does not load
            detail = "; ".join([str(error), *self._messages])
            raise UserError(f"the FMU cannot be loaded: {detail}", file=path) from error
        finally:
            os.chdir(working_directory)  # fmpy leaves it changed when a library fails to load
        self.pointer = int(self._slave.component)
        self._flags = (ctypes.c_bool * 3)()
        self._last_time = ctypes.c_double()
        base = ctypes.addressof(self._flags)
        self._step_tail = (base, base + 1, base + 2, ctypes.addressof(self._last_time))
        self._do_step = self.function("fmi3DoStep", _STEP_SIGNATURE)

    def _log(self, _environment: object, status: int, _category: bytes, message: bytes) -> None:
        if status > 0:
            self._messages.append(message.decode("utf-8", errors="replace"))

    def function(self, name: str, signature: tuple[Any, ...]) -> Any:
        """Return the library function `name` with `signature`, keeping the interpreter lock."""
        address = ctypes.cast(self._slave.dll[name], ctypes.c_void_p).value
        assert address is not None  # fmpy has checked that the function is there
        return ctypes.PYFUNCTYPE(ctypes.c_int, *signature)(address)

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
        """Tell whether the FMU has all these variables."""
        return all(name in self._variables for name in names)

    def names(self, causality: str) -> list[str]:
        """Return the names of all variables of one causality, in the order of the description."""
        return [v.name for v in self.description.modelVariables if v.causality == causality]

    def set_start(self, name: str, value: float | bool) -> None:
        """Set a parameter or a start value before initialisation, in the FMU's unit."""
        exchange = Exchange(self, [name])
        exchange.values[0] = value
        exchange.write()

    def get(self, name: str) -> float:
        """Read one variable now, in the FMU's unit."""
        exchange = Exchange(self, [name])
        exchange.read()
        return float(exchange.values[0])

    def initialize(self, start_ns: TimeNs) -> None:
        """Run the initialisation at `start_ns`."""
        self.time_ns = start_ns
        try:
            self._slave.enterInitializationMode(startTime=ns_to_seconds(start_ns))
            self._slave.exitInitializationMode()
            self._can_terminate = True
        except Exception as error:  # fmpy turns a bad status into a plain Exception
            raise PlantError(self.name, start_ns, self._explain(str(error))) from error

    def step_to(self, end_ns: TimeNs) -> None:
        """Advance the FMU to `end_ns`; PlantError when it refuses or returns early."""
        begin_ns = self.time_ns
        status = self._do_step(
            self.pointer, begin_ns * 1e-9, (end_ns - begin_ns) * 1e-9, True, *self._step_tail
        )
        if status > FMI_WARNING:
            self.failed("doStep", status)
        if self._flags[1] or self._flags[2]:
            raise PlantError(self.name, end_ns, self._explain("the FMU ended the simulation"))
        self.time_ns = end_ns

    def failed(self, what: str, status: int) -> None:
        """Raise PlantError with the messages that the FMU logged."""
        self._can_terminate = False  # FMI 3.0, 2.3.1: after an error only freeing is allowed
        words = {2: "discard", 3: "error", 4: "fatal"}
        raise PlantError(
            self.name, self.time_ns, self._explain(f"{what}: {words.get(status, status)}")
        )

    def _explain(self, text: str) -> str:
        return "; ".join([text, *self._messages[-3:]])

    def close(self) -> None:
        """Terminate and free the instance; the library stays loaded for the next one."""
        if self.pointer:
            if self._can_terminate:
                self._slave.terminate()
            self._slave.fmi3FreeInstance(self._slave.component)
            self.pointer = 0
