"""From an FMU file to an instance: read once per process, checked, FMI 2.0 or 3.0."""

import atexit
import shutil
import tempfile
import zipfile
import zlib
from functools import cache
from pathlib import Path

import fmpy
from fmpy.model_description import ModelDescription

from kernel.cosim.fmi2 import Fmi2Slave
from kernel.cosim.fmi3 import Fmi3Slave
from kernel.cosim.library import Capabilities
from kernel.cosim.slave import Exchange, FmuSlave, FmuState, PlantError
from kernel.errors import UserError

__all__ = [
    "Capabilities",
    "Exchange",
    "FmuSlave",
    "FmuState",
    "PlantError",
    "load_description",
    "load_fmu",
]

_VERSIONS: dict[str, type[FmuSlave]] = {"2.0": Fmi2Slave, "3.0": Fmi3Slave}
_PLATFORMS = {"2.0": fmpy.platform, "3.0": fmpy.platform_tuple}


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
    version = fmi_version(description)
    if version not in _VERSIONS:
        raise UserError(
            "FMI version not supported here", file=path, value=version, allowed=list(_VERSIONS)
        )
    if description.coSimulation is None:
        raise UserError("the FMU has no co-simulation interface", file=path)
    binaries = Path(folder) / "binaries"
    present = sorted(p.name for p in binaries.iterdir()) if binaries.is_dir() else []
    if _PLATFORMS[version] not in present:
        raise UserError(
            f"the FMU has no binary for this platform ({_PLATFORMS[version]})",
            file=path,
            value=" ".join(present) or "none",
            hint="build the FMU for this platform",
        )
    return description, folder


def fmi_version(description: ModelDescription) -> str:
    """Return "2.0" or "3.0" for every release of these, else what the description says."""
    said = str(description.fmiVersion)
    return f"{said[0]}.0" if said.startswith(("2.", "3.")) else said


def load_fmu(path: Path, name: str) -> FmuSlave:
    """Make an instance `name` of the co-simulation FMU at `path`.

    Raises UserError for an FMU that cannot be used.
    """
    description, folder = load_description(path)
    return _VERSIONS[fmi_version(description)](path, name, description, folder)
