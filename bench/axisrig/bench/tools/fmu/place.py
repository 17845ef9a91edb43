"""Which file a user means: an FMU, a model (.mo), or a model of the library by its name."""

from pathlib import Path

from axisrig.bench.machine.fmu_files import library_fmu, own_fmu
from axisrig.bench.rig.reading.file import MODEL_SUFFIX
from axisrig.bench.tools.fmu.library import named
from axisrig.fmus import MODELS
from axisrig.kernel.errors import UserError, nearest


def find_fmu(text: str) -> Path:
    """Return the FMU of a path or a model; a model is built when the cache lacks it.

    Raises UserError when it is neither or cannot be built.
    """
    path = Path(text)
    if path.suffix == MODEL_SUFFIX:
        return own_fmu(path)
    if path.suffix == ".fmu" or path.exists():
        return path
    matching = named(text)
    if len(matching) != 1:
        raise UserError(
            "neither an FMU file nor a model of the library",
            value=text,
            allowed=matching or nearest(text, MODELS) or "a path, or a model of axisrig fmu list",
        )
    return library_fmu(matching[0])
