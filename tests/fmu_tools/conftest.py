"""FMU files written by hand, good and bad."""

import shutil
import subprocess
import sys
import warnings
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fmpy
import pytest
from tests.fmu_tools.trials import CAN, FakeTrial

from axisrig.bench.cli.main import main
from axisrig.bench.tools.fmu import stages
from axisrig.fmus.compiler import find_compiler, this_platform
from axisrig.kernel.cosim.fmi.archive import inspect, unpack
from axisrig.kernel.cosim.fmi.session import session_folder
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS

sys.path.insert(0, str(Path(__file__).parent))  # fmu_rigs.py

from fmu_rigs import LISTS, PROGRAM

Entry = tuple[str | zipfile.ZipInfo, bytes]
Pack = Callable[..., Path]

DESCRIPTION = b'<?xml version="1.0" encoding="UTF-8"?>\n<fmiModelDescription fmiVersion="3.0"/>\n'


@pytest.fixture
def pack(tmp_path: Path) -> Pack:
    """Write an archive of these entries behind a modelDescription.xml; gives its path."""

    def write(*entries: Entry, description: bytes | None = DESCRIPTION) -> Path:
        path = tmp_path / "attack.fmu"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # two entries of one name are what some tests want
            if description is not None:
                packed.writestr("modelDescription.xml", description)
            for name, content in entries:
                packed.writestr(name, content)
        return path

    return write


@pytest.fixture
def refused() -> Callable[[Path], str]:
    """Gives the message with which an archive is refused; nothing may have been written."""

    def check(path: Path) -> str:
        before = sorted(session_folder().iterdir())
        with pytest.raises(UserError) as looked_at:
            inspect(path)
        with pytest.raises(UserError) as unpacked:
            unpack(path)
        assert str(looked_at.value) == str(unpacked.value)
        assert sorted(session_folder().iterdir()) == before
        assert str(path) in str(unpacked.value)
        return str(unpacked.value)

    return check


HEADERS = Path(fmpy.__file__).parent / "c-code"
SOURCE = Path(__file__).with_name("ideal_axis.c")
VARIABLES = """\
<Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
<Float64 name="position_start" valueReference="1" causality="parameter" variability="fixed"
 start="0.13" unit="m"/>
<Float64 name="reference_position" valueReference="2" causality="input" start="0" unit="m"/>
<Float64 name="reference_velocity" valueReference="3" causality="input" start="0" unit="m/s"/>
<Float64 name="reference_time" valueReference="4" causality="input" start="0" unit="s"/>
<Float64 name="reference_end" valueReference="5" causality="input" start="0" unit="s"/>
<Boolean name="enabled" valueReference="6" causality="input" start="false"/>
<Float64 name="position" valueReference="10" causality="output" unit="m"/>
<Float64 name="velocity" valueReference="11" causality="output" unit="m/s"/>
<Float64 name="motor_position" valueReference="12" causality="output" unit="m"/>
<Float64 name="motor_velocity" valueReference="13" causality="output" unit="m/s"/>
<Float64 name="demand_position" valueReference="14" causality="output" unit="m"/>
<Float64 name="way" valueReference="15" causality="output"/>
"""
AXIS = f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Ideal" instantiationToken="{{ideal}}">
<CoSimulation modelIdentifier="ideal" canHandleVariableCommunicationStepSize="true"
 canGetAndSetFMUState="true" canSerializeFMUState="true"/>
<UnitDefinitions>
<Unit name="m"><BaseUnit m="1"/></Unit>
<Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit>
<Unit name="s"><BaseUnit s="1"/></Unit>
</UnitDefinitions>
<ModelVariables>
{VARIABLES}</ModelVariables>
<ModelStructure>
{"".join(f'<Output valueReference="{v}"/>' for v in range(10, 16))}
{"".join(f'<InitialUnknown valueReference="{v}"/>' for v in range(10, 16))}
</ModelStructure>
</fmiModelDescription>
"""


@pytest.fixture(scope="session")
def ideal_axis(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Compile an ideal axis to an FMU.

    defines: the fault that it gets, `CRASH_IN="STEP"` (see ideal_axis.c). change: makes another
    model description of the good one. place: below `binaries/`, by default that of this platform.
    """

    platform = this_platform()

    @cache
    def library(*options: str) -> Path:
        path: Path = tmp_path_factory.mktemp("library") / f"ideal{platform.ending}"
        subprocess.run(
            [
                *(*find_compiler().command, "-shared", "-fPIC", "-pthread", *options),
                "-fvisibility=hidden",
                *(f"-I{HEADERS}", "-o", str(path), str(SOURCE)),
            ],
            check=True,
        )
        return path

    def build(
        name: str = "ideal.fmu",
        *,
        change: Callable[[str], str] = str,
        place: str | None = None,
        **defines: object,
    ) -> Path:
        compiled = library(*(f"-D{key}={value}" for key, value in defines.items()))
        path: Path = tmp_path_factory.mktemp("ideal") / name
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("modelDescription.xml", change(AXIS))
            archive.write(compiled, f"binaries/{place or platform.name}/{compiled.name}")
        return path

    return build


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A folder with a program and the parameter lists."""
    shutil.copytree(LISTS, tmp_path / "lists")
    (tmp_path / "move.nc").write_text(PROGRAM, encoding="utf-8")
    return tmp_path


@pytest.fixture
def axisrig(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str, str]]:
    """Call `axisrig` in a folder of its own; gives exit code, standard output and error.

    Any other exception than the end of the process fails the test: it would be a traceback.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "200")

    def call(*words: str | Path) -> tuple[int, str, str]:
        capsys.readouterr()
        with pytest.raises(SystemExit) as ended:
            main([str(word) for word in words])
        code = ended.value.code
        assert isinstance(code, int)
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return call


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Give trials these properties."""

    def given(**properties: Any) -> type[FakeTrial]:
        own = {"can": SimpleNamespace(**CAN), "made": []}
        made = type("Own", (FakeTrial,), {**own, **properties})
        monkeypatch.setattr(stages, "Trial", made)
        return made

    monkeypatch.setattr(stages, "step_of", lambda _: MS)
    monkeypatch.setattr(stages, "course_findings", lambda *_: [])
    monkeypatch.setattr(stages, "printed_lines", list)
    return given
