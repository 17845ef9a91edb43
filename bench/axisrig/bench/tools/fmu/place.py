"""Which file a user means: a path, or a model of the library by its full or last name."""

from pathlib import Path

from axisrig.bench.tools.fmu.library import named
from axisrig.fmus import MODELS, BuildError, ensure_built
from axisrig.kernel.errors import UserError, nearest


def find_fmu(text: str) -> Path:
    """Return the FMU of a path or a model; a model is built when the cache lacks it.

    Raises UserError when it is neither or cannot be built.
    """
    path = Path(text)
    if path.suffix == ".fmu" or path.exists():
        return path
    matching = named(text)
    if len(matching) != 1:
        raise UserError(
            "neither an FMU file nor a model of the library",
            value=text,
            allowed=matching or nearest(text, MODELS) or "a path, or a model of axisrig fmu list",
        )
    try:
        return ensure_built(matching[0])
    except BuildError as error:
        raise UserError(f"{matching[0]} cannot be built: {error}") from error
