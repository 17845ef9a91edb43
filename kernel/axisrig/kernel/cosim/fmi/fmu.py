"""From an FMU file to an instance: read once per process, checked, FMI 2.0 or 3.0."""

import re
from functools import cache
from pathlib import Path

import fmpy
from fmpy.model_description import ModelDescription, ValidationError

from axisrig.kernel.cosim.fmi.archive import unpack
from axisrig.kernel.cosim.fmi.fmi2 import Fmi2Slave
from axisrig.kernel.cosim.fmi.fmi3 import Fmi3Slave
from axisrig.kernel.cosim.fmi.library import (
    Capabilities,
    EdgeMayBeLostError,
    EndedError,
    FmuState,
    PlantError,
)
from axisrig.kernel.cosim.fmi.slave import Exchange, FmuSlave
from axisrig.kernel.cosim.fmi.variable_index import by_name
from axisrig.kernel.errors import UserError

__all__ = [
    "Capabilities",
    "EdgeMayBeLostError",
    "EndedError",
    "Exchange",
    "FmuSlave",
    "FmuState",
    "PlantError",
    "load_description",
    "load_fmu",
    "read_description",
]

_VERSIONS: dict[str, type[FmuSlave]] = {"2.0": Fmi2Slave, "3.0": Fmi3Slave}
_PLATFORMS = {"2.0": fmpy.platform, "3.0": fmpy.platform_tuple}


_IDENTIFIER = re.compile(r"[A-Za-z_]\w*", re.ASCII)


@cache
def read_description(folder: Path) -> tuple[ModelDescription, tuple[str, ...]]:
    """Read the description of an unpacked FMU; return it with where it breaks the standard.

    Read once in a process: the one of 100 000 variables takes seconds. Raises Exceptions of fmpy
    for what is no description.
    """
    try:
        return fmpy.read_model_description(str(folder)), ()
    except ValidationError as error:
        problems = tuple(str(problem) for problem in error.problems)
        return fmpy.read_model_description(str(folder), validate=False), problems


def _usable(folder: Path) -> ModelDescription:
    """Return a description that may break the standard.

    Many tools leave out or add something that nobody needs to step the FMU. Names that are there
    twice are another matter. Raises ValidationError for these, else what `read_description` raises.
    """
    description, problems = read_description(folder)
    if problems and len(by_name(description)) < len(description.modelVariables):
        raise ValidationError(list(problems))
    return description


def load_description(path: Path) -> tuple[ModelDescription, str]:
    """Return the model description and the unpacked folder of the FMU at `path`.

    Raises UserError when the file is missing, is no FMU or no safe one, or cannot be used here:
    other FMI version, no co-simulation, no binary for this platform.
    """
    folder = unpack(path)
    try:
        description = _usable(folder)
    except Exception as error:  # fmpy reports an unknown version or a missing element like that
        problems = getattr(error, "problems", None) or [str(error) or type(error).__name__]
        more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
        raise UserError(
            f"the model description is rejected: {problems[0]}{more}",
            file=path,
            hint="axisrig fmu check FILE lists what is wrong",
        ) from error
    version = fmi_version(description)
    if version not in _VERSIONS:
        raise UserError(
            "FMI version not supported here", file=path, value=version, allowed=list(_VERSIONS)
        )
    if description.coSimulation is None:
        raise UserError(
            "the FMU has no co-simulation interface",
            file=path,
            hint="export it for co-simulation; a model without its solver cannot be stepped",
        )
    identifier = str(description.coSimulation.modelIdentifier)
    if not _IDENTIFIER.fullmatch(identifier):  # it is part of the library's path
        raise UserError(
            "the model identifier is no C name",
            file=path,
            value=identifier,
            allowed="[A-Za-z_]\\w*",
        )
    binaries = folder / "binaries"
    present = sorted(p.name for p in binaries.iterdir()) if binaries.is_dir() else []
    if _PLATFORMS[version] not in present:
        raise UserError(
            f"the FMU has no binary for this platform ({_PLATFORMS[version]})",
            file=path,
            value=" ".join(present) or "none",
            hint="build the FMU for this platform",
        )
    return description, str(folder)


def fmi_version(description: ModelDescription) -> str:
    """Return "2.0" or "3.0" for every release of these, else what the description says."""
    said = str(description.fmiVersion)
    return f"{said[0]}.0" if said.startswith(("2.", "3.")) else said


def load_fmu(path: Path, name: str) -> FmuSlave:
    """Make an instance `name` of the co-simulation FMU at `path`.

    Raises UserError for an FMU that cannot be used.
    """
    description, folder = load_description(path)
    slave = _VERSIONS[fmi_version(description)](path, name, description, folder)
    slave.problems = read_description(Path(folder))[1]
    return slave
