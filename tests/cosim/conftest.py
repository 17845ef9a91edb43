"""Small FMUs of our own in C, for both versions, as another tool might have exported them."""

import hashlib
import subprocess
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import fmpy
import pytest

from axisrig.fmus.compiler import find_compiler, this_platform
from axisrig.kernel.cosim.fmi.fmu import FmuSlave, load_fmu

SOURCES = Path(__file__).parent
BEHAVIOURS = (
    "plain", "discards long steps", "discards half way", "discards all", "tells no progress",
    "ends", "fails", "warns", "returns early", "returns at once", "crashes", "not a number",
    "stands still", "loses its time", "waits", "ends without a time", "hesitates", "creeps",
)  # fmt: skip
BEHAVIOUR, LEVEL, TIME, TEXT, MOOD = 100, 101, 102, 103, 104
UNITS = (
    '<UnitDefinitions><Unit name="mm"><BaseUnit m="1" factor="0.001"/>'
    '<DisplayUnit name="km" factor="1e-6"/></Unit>'
    '<Unit name="m"><BaseUnit m="1"/></Unit><Unit name="s"><BaseUnit s="1"/></Unit>'
    '<Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit>'
    '<Unit name="mm/s"><BaseUnit m="1" s="-1" factor="0.001"/></Unit>'
    '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>'
    '<Unit name="rad"><BaseUnit rad="1"/></Unit><Unit name="1/s"><BaseUnit s="-1"/></Unit>'
    '<Unit name="turns/min"><BaseUnit rad="1" s="-1" factor="0.10471975511965977"/></Unit>'
    '<Unit name="parsec"/></UnitDefinitions>'
)
ITEMS = "".join(f'<Item name="{n}" value="{v}"/>' for n, v in (("calm", 0), ("nervous", 3)))
Row = tuple[str, str, str | None, str | None]
# name, causality, start, unit; in the order of the value references of the C source
REALS: dict[str, list[Row]] = {
    "odd": [
        ("slide.x", "output", None, "mm"),
        ("slide.u", "input", "0", "mm/s"),
        ("limit", "parameter", "1", "mm"),
        ("scale", "parameter", "1", None),
        ("temperature", "parameter", "20", "degC"),
        ("far", "parameter", "1", "parsec"),
    ],
    "table": [
        ("control.s_set", "input", "0", "mm"),
        ("table.s", "output", None, "mm"),
        ("motor.phi", "output", None, "rad"),
        ("motor.n", "output", None, "turns/min"),
        ("control.gain", "parameter", "40", "1/s"),
        ("table.s_start", "parameter", "0", "mm"),
        ("oil", "parameter", "1", "parsec"),
    ],
    "switch": [
        ("tip.depth", "input", "-1000", None),
        ("contact_v", "output", None, None),
        ("trip", "parameter", "-100", "mm"),
    ],
    "gate": [
        ("step_time", "input", "0", "s"),
        ("step_size", "input", "1", "s"),
        ("z_start", "input", "0", "m"),
        ("z_rate_start", "input", "0", "m/s"),
        ("z_end", "input", "0", "m"),
        ("z_rate_end", "input", "0", "m/s"),
        ("trip", "parameter", "0", "m"),
        ("beam", "parameter", "1", "m"),
    ],
    "rod": [
        ("reference_position", "input", "0", "m"),
        ("reference_velocity", "input", "0", "m/s"),
        ("reference_time", "input", "0", "s"),
        ("reference_end", "input", "0", "s"),
        ("position", "output", None, "m"),
        ("velocity", "output", None, "m/s"),
        ("position_start", "parameter", "0", "m"),
    ],
}


def build_fmu(
    folder: Path, version: int, model: str = "odd", name: str | None = None, **promises: str | bool
) -> Path:
    """Build `<name>.fmu` of a C model.

    promises: attributes of the co-simulation interface; `stepSize` is that of the experiment.
    """
    found = {"canHandleVariableCommunicationStepSize": True, **promises}
    identifier = model + hashlib.sha256(repr((version, found)).encode()).hexdigest()[:8]
    library = folder / f"{identifier}{this_platform().ending}"
    if not library.exists():
        command = [*find_compiler().command, "-std=c11", "-O1", "-shared", "-fPIC"]
        command += [f"-DFMI={version}", str(SOURCES / f"{model}.c"), "-o", str(library), "-lm"]
        subprocess.run(command, check=True)
    path = folder / f"{name or model}.fmu"
    place = fmpy.platform if version == 2 else fmpy.platform_tuple
    with zipfile.ZipFile(path, "w") as archive:
        # Without the date of the day, so that one FMU built twice has the same bytes
        text = _description(version, model, identifier, found)
        archive.writestr(zipfile.ZipInfo("modelDescription.xml"), text)
        name = f"binaries/{place}/{library.name}"
        archive.writestr(zipfile.ZipInfo(name), library.read_bytes())
    return path


def _description(version: int, model: str, identifier: str, found: dict[str, str | bool]) -> str:
    found = dict(found)
    step = found.pop("stepSize", None)
    experiment = f'<DefaultExperiment stepSize="{step}"/>' if step else ""
    flags = " ".join(f'{key}="{str(value).lower()}"' for key, value in found.items())
    token = "guid" if version == 2 else "instantiationToken"
    rows = REALS[model]
    variables = [_variable(version, number, row) for number, row in enumerate(rows)]
    outputs = [number for number, row in enumerate(rows) if row[1] == "output"]
    if version == 2:
        types = f'<SimpleType name="Mood"><Enumeration>{ITEMS}</Enumeration></SimpleType>'
        variables += [
            f'<ScalarVariable name="behaviour" valueReference="{BEHAVIOUR}" causality="parameter"'
            ' variability="fixed"><Integer start="0"/></ScalarVariable>',
            f'<ScalarVariable name="level" valueReference="{LEVEL}" causality="output"'
            ' variability="discrete"><Boolean/></ScalarVariable>',
            f'<ScalarVariable name="text" valueReference="{TEXT}" causality="parameter"'
            ' variability="fixed"><String start=""/></ScalarVariable>',
            f'<ScalarVariable name="mood" valueReference="{MOOD}" causality="parameter"'
            ' variability="fixed"><Enumeration declaredType="Mood" start="0"/></ScalarVariable>',
        ]
        indices = [*(number + 1 for number in outputs), len(rows) + 2]
        unknowns = "".join(f'<Unknown index="{index}"/>' for index in indices)
        structure = f"<Outputs>{unknowns}</Outputs><InitialUnknowns>{unknowns}</InitialUnknowns>"
    else:
        types = f'<EnumerationType name="Mood">{ITEMS}</EnumerationType>'
        variables += [
            f'<Int32 name="behaviour" valueReference="{BEHAVIOUR}" causality="parameter"'
            ' variability="fixed" start="0"/>',
            f'<Boolean name="level" valueReference="{LEVEL}" causality="output"/>',
            f'<Float64 name="time" valueReference="{TIME}" causality="independent"'
            ' variability="continuous"/>',
            f'<String name="text" valueReference="{TEXT}" causality="parameter"'
            ' variability="fixed"><Start value=""/></String>',
            f'<Enumeration name="mood" valueReference="{MOOD}" causality="parameter"'
            ' variability="fixed" declaredType="Mood" start="0"/>',
        ]
        structure = "".join(
            f'<{kind} valueReference="{reference}"/>'
            for kind in ("Output", "InitialUnknown")
            for reference in (*outputs, LEVEL)
        )
    return (
        f'<?xml version="1.0"?><fmiModelDescription fmiVersion="{version}.0" modelName="{model}"'
        f' {token}="{model}"><CoSimulation modelIdentifier="{identifier}" {flags}/>{UNITS}'
        f"<TypeDefinitions>{types}</TypeDefinitions>{experiment}<ModelVariables>{''.join(variables)}</ModelVariables>"
        f"<ModelStructure>{structure}</ModelStructure></fmiModelDescription>"
    )


def _variable(version: int, reference: int, row: Row) -> str:
    name, causality, start, unit = row
    variability = "fixed" if causality == "parameter" else "continuous"
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
def fmu(odd_folder: Path, version: int) -> Callable[..., Path]:
    """Build the FMU of a C model with promises of its interface."""
    return lambda model="odd", **found: build_fmu(odd_folder, version, model, **found)


@pytest.fixture
def odd(odd_folder: Path, version: int) -> Iterator[Callable[..., FmuSlave]]:
    """Load and initialise an instance with a behaviour; u = 100 mm/s unless given."""
    slaves: list[FmuSlave] = []

    def load(behaviour: str = "plain", *, name: str = "odd", **promises: str | bool) -> FmuSlave:
        slave = load_fmu(build_fmu(odd_folder, version, **promises), name)
        slave.set_start("behaviour", BEHAVIOURS.index(behaviour))
        slave.set_start("slide.u", 100.0)
        slave.initialize(0)
        slaves.append(slave)
        return slave

    yield load
    for slave in slaves:
        slave.close()


# ---- a rig with two of them

LISTS = SOURCES.parents[1] / "testplans" / "rigs" / "lists"
RIG = f"""\
title = "table and switch of another tool"

[channel]
list = "{LISTS}/channel.lst"

[segment.can1]

[drive.servo]

[axis.Z]
list = "{LISTS}/axis-z-fine.lst"
segment = "can1"
node = 3
drive = "servo"
plant = "table"
probe_1 = "switch"

[plant.table]
fmu = "table.fmu"
start = {{ "table.s_start_mm" = 103, "control.gain" = 40 }}

[plant.table.map]
demand = "control.s_set"
position = "table.s"

[plant.switch]
fmu = "switch.fmu"
wire = {{ z = "table" }}
start = {{ trip_mm = -100 }}

[plant.switch.map]
z_position = {{ variable = "tip.depth", unit = "mm", sign = -1 }}
signal = {{ variable = "contact_v", threshold = 12 }}
"""
PROGRAM = """\
N10 G90 G1 Z102 F3000
N20 G100 Z98 F500
N30 #MSG SYN["V.A.MERF.Z=%d", V.A.MERF.Z]
N40 M30
"""


Place = Callable[..., Path]


@pytest.fixture
def place(tmp_path: Path, fmu: Callable[..., Path], version: int) -> Place:
    """A folder with FMUs, rig and program; changes: (old text, new text) of the rig.

    saves: whether states can be saved. table, switch: more that the FMUs promise.
    """

    def make(
        *changes: tuple[str, str],
        saves: bool = True,
        **promises: dict[str, str | bool],
    ) -> Path:
        flag = "canGetAndSetFMUstate" if version == 2 else "canGetAndSetFMUState"
        for model in ("table", "switch"):
            built = fmu(model, **{flag: saves, **promises.get(model, {})})
            (tmp_path / built.name).write_bytes(built.read_bytes())
        text = RIG
        for old, new in changes:
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        (tmp_path / "rig.toml").write_text(text, encoding="utf-8")
        (tmp_path / "part.nc").write_text(PROGRAM, encoding="utf-8")
        return tmp_path

    return make
