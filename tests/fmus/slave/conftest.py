"""One face for slaves of both versions of FMI, driven through fmpy alone."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave

from axisrig.fmus import FMI_VERSIONS

WORDS = {
    "2.0": {"Float64": "Real", "Int32": "Integer"},
    "3.0": {"Real": "Float64", "Integer": "Int32"},
}


class Slave:
    """An instance by names of variables, not yet initialized; keeps the messages that it logs."""

    def __init__(self, path: Path, folder: Path, name: str = "slave") -> None:
        self.description = fmpy.read_model_description(str(path))
        self.fmi: str = self.description.fmiVersion
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[str] = []
        kind = FMU2Slave if self.fmi == "2.0" else FMU3Slave
        self.slave = kind(
            guid=self.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self._callbacks = fmi2CallbackFunctions()  # must live as long as the instance
        self._callbacks.logger = fmi2CallbackLoggerTYPE(self._log2)
        self.instantiate()
        self.time = 0.0

    def instantiate(self) -> None:
        if self.fmi == "2.0":
            self.slave.instantiate(callbacks=self._callbacks, loggingOn=True)
        else:
            self.slave.instantiate(logMessage=self._log3, loggingOn=True)

    def _log2(self, _env: Any, _name: bytes, _status: int, _category: bytes, text: bytes) -> None:
        self.messages.append(text.decode())

    def _log3(self, _env: Any, _status: int, _category: bytes, text: bytes) -> None:
        self.messages.append(text.decode())

    def enter(self, start: float = 0.0, stop: float | None = None) -> None:
        """Into initialization."""
        self.time = start
        if self.fmi == "2.0":
            self.slave.setupExperiment(startTime=start, stopTime=stop)
            self.slave.enterInitializationMode()
        else:
            self.slave.enterInitializationMode(startTime=start, stopTime=stop)

    def start(self, **values: float) -> "Slave":
        """Initialize with values."""
        self.enter()
        self.set(**values)
        self.slave.exitInitializationMode()
        return self

    def _call(self, kind: str, name: str) -> Any:
        word = self.variables[name].type
        return getattr(self.slave, kind + WORDS[self.fmi].get(word, word))

    def set(self, **values: float) -> None:
        for name, value in values.items():
            self._call("set", name)([self.variables[name].valueReference], [value])

    def get(self, name: str) -> Any:
        return self._call("get", name)([self.variables[name].valueReference])[0]

    def outputs(self) -> dict[str, Any]:
        return {
            v.name: self.get(v.name) for v in self.variables.values() if v.causality == "output"
        }

    def step(self, size: float, begin: float | None = None) -> Any:
        begin = self.time if begin is None else begin
        answer = self.slave.doStep(begin, size)
        self.time = begin + size
        return answer

    def run(self, count: int, size: float = 1e-3) -> list[dict[str, Any]]:
        """Outputs after each of `count` steps."""
        found = []
        for _ in range(count):
            self.step(size)
            found.append(self.outputs())
        return found

    def save(self) -> Any:
        return self.slave.getFMUState()

    def restore(self, state: Any, time: float) -> None:
        self.slave.setFMUState(state)
        self.time = time

    def forget(self, state: Any) -> None:
        self.slave.freeFMUState(state)

    def serialized(self, state: Any) -> bytes:
        serialize = "serializeFMUstate" if self.fmi == "2.0" else "serializeFMUState"
        return bytes(getattr(self.slave, serialize)(state))

    def deserialized(self, data: bytes) -> Any:
        deserialize = "deSerializeFMUstate" if self.fmi == "2.0" else "deserializeFMUState"
        return getattr(self.slave, deserialize)(data)

    def reset(self) -> None:
        self.slave.reset()
        self.time = 0.0

    def refusal(self, call: Any, *arguments: Any, **named: Any) -> str:
        """The message of a call that must be refused."""
        before = len(self.messages)
        try:
            call(*arguments, **named)
        except FMICallException:
            assert len(self.messages) == before + 1, self.messages[before:]
            return self.messages[-1]
        raise AssertionError("the call was not refused")

    def close(self) -> None:
        """Free the instance; the library stays loaded."""
        free = self.slave.fmi2FreeInstance if self.fmi == "2.0" else self.slave.fmi3FreeInstance
        free(self.slave.component)


Made = Callable[..., Slave]


@pytest.fixture(scope="module", params=FMI_VERSIONS)
def fmi(request: pytest.FixtureRequest) -> str:
    """Each version of the standard in turn."""
    return str(request.param)


@pytest.fixture(scope="module")
def unpack(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Path], tuple[Path, Path]]:
    """Unpacks an FMU; gives file and folder."""

    def unpacked(path: Path) -> tuple[Path, Path]:
        folder = tmp_path_factory.mktemp("unpacked")
        fmpy.extract(str(path), str(folder))
        return path, folder

    return unpacked


@pytest.fixture
def slaves() -> Iterator[Made]:
    """Makes slaves of unpacked FMUs and frees them in the end."""
    made: list[Slave] = []

    def make(path: Path, folder: Path) -> Slave:
        made.append(Slave(path, folder))
        return made[-1]

    yield make
    for slave in made:
        slave.close()
