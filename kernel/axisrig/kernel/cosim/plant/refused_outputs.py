"""The error for outputs that are no numbers."""

from collections.abc import Sequence
from math import isfinite

from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.fmi.roles import Roles


def refusal(roles: Roles, names: Sequence[str], values: Sequence[float]) -> PlantError:
    """Return an error that names each value which is no number or infinite.

    names: the role of each value. What the FMU itself reports is named with its variable.
    """
    found = zip(names, values, strict=True)
    wrong = [(role, value) for role, value in found if not isfinite(value)]
    texts = [
        f"{roles.bound[role].variable} ({role}) is {value}"
        for role, value in wrong
        if roles.has(role)
    ]
    text = ", ".join(texts or [f"{role} is {value}" for role, value in wrong])
    return PlantError(roles.slave.name, roles.slave.time_ns, text)
