"""The FMU of a plant: a file, or built from a model, and what a user should know of it."""

from functools import cache
from pathlib import Path

from axisrig.bench.rig.reading.file import MODEL_SUFFIX, PlantTable, rig_error
from axisrig.bench.rig.settings import Settings
from axisrig.fmus import MODELS, BuildError, ensure_built, ensure_own_built
from axisrig.kernel.cosim.fmi.fmu import FmuSlave
from axisrig.kernel.cosim.fmi.roles import Roles
from axisrig.kernel.cosim.fmi.rules import rule_of
from axisrig.kernel.errors import UserError, near_files, nearest


def plant_path(settings: Settings, instance: str, table: PlantTable) -> Path:
    """Return the FMU of a plant; a model is built when the cache lacks it."""
    if table.fmu.endswith(".fmu"):
        return Path(table.fmu)
    keys = ("plant", instance, "fmu")
    if table.fmu.endswith(MODEL_SUFFIX):
        source = Path(table.fmu)
        if not source.is_file():
            hint = near_files(Path(), table.fmu)
            raise rig_error(
                settings.files, keys, "there is no such model", value=table.fmu, hint=hint
            )
        return own_fmu(source)
    if table.fmu not in MODELS:
        raise rig_error(
            settings.files,
            keys,
            "neither a model of the library nor a path that ends in .fmu or .mo",
            value=table.fmu,
            allowed=nearest(table.fmu, MODELS) or MODELS,
        )
    return library_fmu(table.fmu)


@cache
def library_fmu(model: str) -> Path:
    """Return the FMU of a model of the library; looked up once per process, which costs 3 ms.

    Raises UserError when it cannot be built.
    """
    try:
        return ensure_built(model)
    except BuildError as error:
        raise UserError(f"{model} cannot be built: {error}") from error


def own_fmu(source: Path) -> Path:
    """Return the FMU of a model of the user, built when something has changed.

    Raises UserError with the file and the line of a mistake.
    """
    try:
        return ensure_own_built(source)
    except BuildError as error:
        file = source.parent / error.file if error.file else source
        raise UserError(
            f"the model cannot be built: {error.message}",
            file=file if file.is_file() else source,
            line=error.line if file.is_file() else None,
        ) from error


def problems(slave: FmuSlave) -> list[str]:
    """Say that the description of an FMU breaks the standard."""
    if not slave.problems:
        return []
    more = f" (and {len(slave.problems) - 1} more)" if len(slave.problems) > 1 else ""
    return [
        f"its description breaks the standard ({rule_of(slave.problems[0]).name}):"
        f" {slave.problems[0]}{more};"
        f" axisrig fmu check {slave.path.name} lists it"
    ]


def remarks(table: PlantTable, roles: Roles) -> list[str]:
    """Say what the bench makes of an FMU of the user."""
    if not table.fmu.endswith(".fmu"):
        return []
    can, spare = roles.slave.can, roles.spare_inputs()
    lines = []
    if roles.slave.grid_ns is not None:
        between = "interpolated" if roles.kind == "axis" else "held"
        lines.append(f"takes steps of {roles.slave.grid_ns / 1e6:g} ms only: {between} between")
    elif not can.can_vary_step:
        lines.append("takes steps of one length only and does not say of which")
    if can.needs_tool:
        lines.append("needs the tool that made it on this machine (needsExecutionTool)")
    if spare:
        lines.append(f"nothing is wired to {', '.join(spare)}: start values are kept")
    return lines
