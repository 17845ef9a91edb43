"""Variables of a model description by name and by causality, sorted once for all its instances.

A description of 100 000 variables is gone through once, not once for each instance.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from fmpy.model_description import ModelDescription, ModelVariable

_KEPT = 64
"""So many descriptions keep their index."""


class _Index(NamedTuple):
    description: ModelDescription
    by_name: Mapping[str, ModelVariable]
    by_causality: Mapping[str, Sequence[ModelVariable]]


_INDICES: dict[int, _Index] = {}
"""By the identity of the description, which the index keeps alive."""


def by_name(description: ModelDescription) -> Mapping[str, ModelVariable]:
    """Return the variables by their names."""
    return _index(description).by_name


def of_causality(description: ModelDescription, causality: str) -> Sequence[ModelVariable]:
    """Return the variables of one causality in the order of the description."""
    return _index(description).by_causality.get(causality, ())


def _index(description: ModelDescription) -> _Index:
    found = _INDICES.get(id(description))
    if found is None:
        by_causality: dict[str, list[ModelVariable]] = {}
        for variable in description.modelVariables:
            by_causality.setdefault(variable.causality, []).append(variable)
        names = {variable.name: variable for variable in description.modelVariables}
        found = _INDICES[id(description)] = _Index(description, names, by_causality)
        if len(_INDICES) > _KEPT:
            del _INDICES[next(iter(_INDICES))]
    return found
