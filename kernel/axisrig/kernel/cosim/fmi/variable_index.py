"""Variables of a model description by name and by causality, sorted once for all its instances.

A description of 100 000 variables is gone through once, not once for each instance.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache

from fmpy.model_description import ModelDescription, ModelVariable

_KEPT = 64
"""So many descriptions keep their index."""


@lru_cache(maxsize=_KEPT)
def by_name(description: ModelDescription) -> Mapping[str, ModelVariable]:
    """Return the variables by their names."""
    return {variable.name: variable for variable in description.modelVariables}


@lru_cache(maxsize=_KEPT)
def _by_causality(description: ModelDescription) -> Mapping[str, Sequence[ModelVariable]]:
    found: dict[str, list[ModelVariable]] = {}
    for variable in description.modelVariables:
        found.setdefault(variable.causality, []).append(variable)
    return found


def of_causality(description: ModelDescription, causality: str) -> Sequence[ModelVariable]:
    """Return the variables of one causality in the order of the description."""
    return _by_causality(description).get(causality, ())
