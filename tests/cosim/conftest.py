"""Small FMUs of our own from `odd.c`, for both versions, that misbehave on demand."""

import hashlib
import subprocess
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import fmpy
import pytest

from fmus.compiler import find_compiler, this_platform
from kernel.cosim.fmu import FmuSlave, load_fmu

SOURCE = Path(__file__).with_name("odd.c")
BEHAVIOURS = (
    "plain", "discards long steps", "discards half way", "discards all", "tells no progress",
    "ends", "fails", "warns", "returns early", "returns at once", "crashes", "not a number",
)  # fmt: skip
UNITS = (
    '<UnitDefinitions><Unit name="mm"><BaseUnit m="1" factor="0.001"/>'
    '<DisplayUnit name="km" factor="1e-6"/></Unit>'
    '<Unit name="mm/s"><BaseUnit m="1" s="-1" factor="0.001"/></Unit>'
    '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit></UnitDefinitions>'
)
# name, causality, variability, start, unit
REALS = (
    ("slide.x", "output", "continuous", None, "mm"),
    ("slide.u", "input", "continuous", "0", "mm/s"),
    ("limit", "parameter", "fixed", "1", "mm"),
    ("scale", "parameter", "fixed", "1", None),
    ("temperature", "parameter", "fixed", "20", "degC"),
)


def build_odd(folder: Path, version: int, name: str = "odd", **promises: str | bool) -> Path:
    """Build `<name>.fmu`; promises: attributes of the co-simulation interface."""
    told = {"canHandleVariableCommunicationStepSize": True, **promises}
    identifier = "odd" + hashlib.sha256(repr((version, told)).encode()).hexdigest()[:8]
    library = folder / f"{identifier}{this_platform().ending}"
    if not library.exists():
        command = [*find_compiler().command, "-std=c11", "-O1", "-shared", "-fPIC"]
        command += [f"-DFMI={version}", str(SOURCE), "-o", str(library), "-lm"]
        subprocess.run(command, check=True)
    path = folder / f"{name}.fmu"
    place = fmpy.platform if version == 2 else fmpy.platform_tuple
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", _description(version, identifier, told))
        archive.write(library, f"binaries/{place}/{library.name}")
    return path


def _description(version: int, identifier: str, told: dict[str, str | bool]) -> str:
    flags = " ".join(f'{key}="{str(value).lower()}"' for key, value in told.items())
    interface = f'<CoSimulation modelIdentifier="{identifier}" {flags}/>'
    token = "guid" if version == 2 else "instantiationToken"
    variables = [_variable(version, *entry) for entry in enumerate(REALS)]
    number = len(REALS)
    if version == 2:
        variables += [
            f'<ScalarVariable name="behaviour" valueReference="{number}" causality="parameter"'
            ' variability="fixed"><Integer start="0"/></ScalarVariable>',
            f'<ScalarVariable name="level" valueReference="{number + 1}" causality="output"'
            ' variability="discrete"><Boolean/></ScalarVariable>',
        ]
        outputs = "".join(f'<Unknown index="{i}"/>' for i in (1, number + 2))
        structure = f"<Outputs>{outputs}</Outputs><InitialUnknowns>{outputs}</InitialUnknowns>"
    else:
        variables += [
            f'<Int32 name="behaviour" valueReference="{number}" causality="parameter"'
            ' variability="fixed" start="0"/>',
            f'<Boolean name="level" valueReference="{number + 1}" causality="output"/>',
            f'<Float64 name="time" valueReference="{number + 2}" causality="independent"'
            ' variability="continuous"/>',
        ]
        structure = "".join(
            f'<{kind} valueReference="{i}"/>'
            for kind in ("Output", "InitialUnknown")
            for i in (0, number + 1)
        )
    return (
        f'<?xml version="1.0"?><fmiModelDescription fmiVersion="{version}.0" modelName="odd"'
        f' {token}="odd">{interface}{UNITS}<ModelVariables>{"".join(variables)}</ModelVariables>'
        f"<ModelStructure>{structure}</ModelStructure></fmiModelDescription>"
    )


def _variable(
    version: int, reference: int, row: tuple[str, str, str, str | None, str | None]
) -> str:
    name, causality, variability, start, unit = row
    head = (
        f'name="{name}" valueReference="{reference}" causality="{causality}"'
        f' variability="{variability}"'
    )
    tail = (f' start="{start}"' if start else "") + (f' unit="{unit}"' if unit else "")
    if version == 2:
        return f"<ScalarVariable {head}><Real{tail}/></ScalarVariable>"
    return f"<Float64 {head}{tail}/>"


@pytest.fixture(scope="session")
def odd_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where libraries are compiled once."""
    return tmp_path_factory.mktemp("odd")


@pytest.fixture(params=[2, 3], ids=["FMI2", "FMI3"])
def version(request: pytest.FixtureRequest) -> int:
    """Both versions of FMI."""
    return int(request.param)


@pytest.fixture
def odd_fmu(odd_folder: Path, version: int) -> Callable[..., Path]:
    """Build `<name>.fmu` with promises of its interface."""
    return lambda **told: build_odd(odd_folder, version, **told)


@pytest.fixture
def odd(odd_folder: Path, version: int) -> Iterator[Callable[..., FmuSlave]]:
    """Load and initialise an instance with a behaviour; u = 100 mm/s unless told."""
    slaves: list[FmuSlave] = []

    def load(behaviour: str = "plain", *, name: str = "odd", **promises: str | bool) -> FmuSlave:
        slave = load_fmu(build_odd(odd_folder, version, **promises), name)
        slave.set_start("behaviour", BEHAVIOURS.index(behaviour))
        slave.set_start("slide.u", 100.0)
        slave.initialize(0)
        slaves.append(slave)
        return slave

    yield load
    for slave in slaves:
        slave.close()
