"""An FMU under test, driven through fmpy alone."""

import re
import shutil
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
import pytest
from fmpy.fmi3 import FMU3Slave
from tests.small_fmus import small_fmu

from axisrig.fmus import ensure_built

SERVO = "AxisRig.Drives.ServoAxis"
PROBE = "AxisRig.Sensors.TouchProbe"


@cache
def description_of(path: Path) -> Any:
    """The model description of an FMU; to read it takes longer than most tests."""
    return fmpy.read_model_description(str(path))


class Fmu:
    """One instance of an FMU with variables by name; keeps the messages that it logs."""

    def __init__(self, path: Path, folder: Path, **start: float) -> None:
        self.description = description_of(path)
        self._variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[str] = []
        self.slave = FMU3Slave(
            guid=self.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="under test",
        )
        self.slave.instantiate(loggingOn=True, logMessage=self.log)
        self.time = 0.0
        self.start(**start)

    def start(self, **values: float | list[float]) -> None:
        """Set values and go through initialization."""
        self.slave.enterInitializationMode(startTime=0.0)
        self.set(**values)
        self.slave.exitInitializationMode()
        self.time = 0.0

    def restart(self, **values: float | list[float]) -> None:
        """Go back to the start values of the description, but for `values`."""
        self.slave.reset()
        self.start(**values)

    def log(self, environment: Any, status: int, category: bytes, message: bytes) -> None:
        self.messages.append(message.decode())

    def _call(self, kind: str, name: str) -> Any:
        type_name = self._variables[name].type
        held = {"Enumeration": "Int64"}.get(type_name, type_name)
        return getattr(self.slave, f"{kind}{held}")

    def set(self, **values: float | list[float]) -> None:
        """Set variables; an array takes a list of all its elements."""
        for name, value in values.items():
            elements = value if isinstance(value, list) else [value]
            self._call("set", name)([self._variables[name].valueReference], elements)

    def get(self, name: str) -> Any:
        return self._call("get", name)([self._variables[name].valueReference])[0]

    def __getattr__(self, name: str) -> Any:
        """A variable of the FMU as an attribute."""
        if name.startswith("_") or name not in self._variables:
            raise AttributeError(name)
        return self.get(name)

    def outputs(self) -> dict[str, Any]:
        """All outputs by name."""
        return {
            v.name: self.get(v.name)
            for v in self.description.modelVariables
            if v.causality == "output"
        }

    def step(self, size: float) -> None:
        self.slave.doStep(self.time, size)
        self.time += size

    def step_to(self, instant: float) -> None:
        """Step to an instant without gathering rounding errors."""
        self.slave.doStep(self.time, instant - self.time)
        self.time = instant


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for FMUs of this session; those of the library come from the user's cache."""
    return tmp_path_factory.mktemp("fmus")


@pytest.fixture(scope="session")
def load(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[..., Fmu]]:
    """Loads a model by full name, or a built file, with start values."""
    folders: dict[Path, Path] = {}
    instances: list[Fmu] = []

    def loader(model: str | Path, **start: float) -> Fmu:
        path = model if isinstance(model, Path) else ensure_built(model)
        if path not in folders:
            folders[path] = tmp_path_factory.mktemp("unpacked")
            fmpy.extract(str(path), str(folders[path]))
        instances.append(Fmu(path, folders[path], **start))
        return instances[-1]

    yield loader
    for instance in instances:
        instance.slave.freeInstance()
    for folder in folders.values():
        shutil.rmtree(folder, ignore_errors=True)


@pytest.fixture
def servo(load: Callable[..., Fmu]) -> Callable[..., Fmu]:
    """A servo axis with start values."""
    return lambda **start: load(SERVO, **start)


@pytest.fixture
def probe(load: Callable[..., Fmu]) -> Callable[..., Fmu]:
    """A touch probe with start values."""
    return lambda **start: load(PROBE, **start)


MODEL = """package Small
  model Plant
    output Real y(start=0);
    Real x(start={x_start}, fixed={fixed});
    Integer n(start={n_start}, fixed=true);
    {declaration}
  equation
    {equation}
  end Plant;
{classes}
end Small;
"""


class Plants:
    """Builds and loads FMUs of small models with a variable y, a state x and a whole number n."""

    def __init__(self, load: Callable[..., Fmu], folder: Path) -> None:
        self._load, self._folder, self._count = load, folder, 0

    def build(
        self,
        equation: str,
        declaration: str = "",
        classes: str = "",
        step_s: float | None = None,
        x_start: float = 1,
        n_start: int = 0,
        x_fixed: bool = True,
    ) -> Path:
        """The FMU. A variable y, x or n that no equation names is 0."""
        self._count += 1
        folder = self._folder / str(self._count)
        (folder / "Small").mkdir(parents=True)
        for name in "xyn":
            if not re.search(rf"\b{name}\b", equation):
                equation += f" {name} = 0;"
        fixed = "true" if x_fixed and "der(x)" in equation else "false"
        text = MODEL.format(**locals())
        (folder / "Small" / "package.mo").write_text(text, encoding="utf-8")
        return small_fmu("Small.Plant", folder / "Small", step_s)

    def __call__(self, equation: str, *args: Any, **options: Any) -> Fmu:
        """An instance after initialization; options that `build` does not have are values."""
        known = {"step_s", "x_start", "n_start", "x_fixed"}
        path = self.build(equation, *args, **{k: v for k, v in options.items() if k in known})
        return self._load(path, **{k: v for k, v in options.items() if k not in known})


@pytest.fixture
def plant(load: Callable[..., Fmu], tmp_path: Path) -> Plants:
    """Builds small models: plant(equation, declaration, classes, **values)."""
    return Plants(load, tmp_path)
