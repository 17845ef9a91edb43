"""What a distance sensor of the plant reports, whichever of its roles its FMU fills."""

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant.distance import PlantDistance

ALL = {"distance": 0.25, "distance_true": 0.5, "valid": 0.0, "touching": 1.0}


class Values:
    """Values of some roles, read when they are asked for."""

    def __init__(self, names: Sequence[str], given: Mapping[str, float]) -> None:
        self.names, self.given, self.values = list(names), given, [0.0] * len(names)

    def read(self) -> None:
        self.values = [self.given[name] for name in self.names]


def sensor(given: Mapping[str, float]) -> Any:
    roles: Any = SimpleNamespace(
        slave=SimpleNamespace(name="eye", time_ns=0),
        has=given.__contains__,
        has_group=lambda _: False,
        exchange=lambda names: Values(names, given),
    )
    return PlantDistance(roles, {})


@pytest.mark.parametrize("true", [{}, {"distance_true": 0.5}])
@pytest.mark.parametrize("valid", [{}, {"valid": 0.0}, {"valid": 1.0}])
@pytest.mark.parametrize("touching", [{}, {"touching": 0.0}, {"touching": 1.0}])
def test_each_role_is_its_own_and_one_that_is_missing_has_its_usual_value(
    true: dict[str, float], valid: dict[str, float], touching: dict[str, float]
) -> None:
    """Valid, not touching, no true distance."""
    made = sensor({"distance": 0.25, **touching, **valid, **true})
    made.look()
    expected = (
        *(0.25, true.get("distance_true")),
        *(bool(valid.get("valid", 1)), bool(touching.get("touching", 0))),
    )
    found = (made.distance_m, made.distance_true_m, made.is_valid, made.is_touching)
    assert found == expected
    assert made.reported_at(0) == expected


def test_levels_that_go_come_back() -> None:
    """Each look is of that instant; what was before is found at its own."""
    given = dict(ALL)
    made, seen = sensor(given), []
    for number, (valid, touching) in enumerate([(1, 0), (0, 1), (1, 1), (0, 0), (1, 0)]):
        given["valid"], given["touching"], given["distance"] = valid, touching, number * 0.1
        made.slave.time_ns = number * 10
        made.look()
        seen.append((number * 0.1, 0.5, bool(valid), bool(touching)))
        assert (made.is_valid, made.is_touching) == (bool(valid), bool(touching))
    assert [made.reported_at(at_ns) for at_ns in (0, 10, 20, 30, 40)] == seen
    assert made.reported_at(29) == seen[2]
    with pytest.raises(PlantError, match="no distance is kept"):
        made.reported_at(-1)
