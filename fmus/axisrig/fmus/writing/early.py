"""Levels at whose change a step may end early, where the importer allows it (FMI 3.0).

A class names them in its annotation `__axisrig(returns_early = "signal")`: Boolean outputs, several
with commas between.
"""

import re
from collections.abc import Sequence

from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.ir import Ir
from axisrig.fmus.writing.variables import Variable

_NAMED = re.compile(r"\b__axisrig\s*\([^()]*\breturns_early\s*=\s*\"([^\"]*)\"")


def early_levels(ir: Ir, variables: Sequence[Variable]) -> list[int]:
    """Their slots in p, in the order of the annotation; empty for a class without it.

    Raises BuildError when a name is not that of a Boolean output.
    """
    name = re.escape(ir.model.rpartition(".")[2])
    body = re.compile(rf"\b(?:model|block|class)\s+{name}\b.*?\bend\s+{name}\s*;", re.DOTALL)
    texts = [
        found[0]
        for path, text in ir.files.values()
        if path.stem in (*ir.model.split("."), "package") and (found := body.search(text))
    ]
    named = next((found[1] for text in texts if (found := _NAMED.search(text))), "")
    levels = {
        v.name: v.index
        for v in variables
        if v.causality == "output" and v.type == "Boolean" and v.vector == "p" and v.count == 1
    }
    words = [word.strip() for word in named.split(",") if word.strip()]
    for word in words:
        if word not in levels:
            message = f"returns_early: {word} is no Boolean output; there are {', '.join(levels)}"
            raise BuildError(ir.model, None, message)
    return [levels[word] for word in words]
