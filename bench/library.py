"""The plant library as the command line shows it."""

from collections.abc import Iterator

from fmus import CATALOGUE, MODELS, BuildError, ensure_built
from kernel.errors import UserError, nearest


def build_models(model: str | None) -> Iterator[str]:
    """Build one model or all; yield a line for each. Raises UserError when a build fails."""
    if model is not None and model not in MODELS:
        raise UserError(
            "the library has no such model",
            value=model,
            allowed=nearest(model, MODELS) or MODELS,
        )
    for name in [model] if model else MODELS:
        try:
            yield f"{name}: {ensure_built(name)}"
        except BuildError as error:
            raise UserError(f"{name} cannot be built: {error}") from error


def listing() -> str:
    """Return the models with their internal steps and titles, one a line."""
    width = max(len(name) for name in MODELS)
    return "\n".join(
        f"{row.name:<{width}}  {row.step_s * 1e6:4.0f} us  {row.title}"
        for row in CATALOGUE.values()
    )
