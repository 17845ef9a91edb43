"""Parameters of the FMU of an axis, as closed forms take them."""

from axisrig.bench.record.axes import PlantRecord

_INERTIA = (1, 2, 0, 0, 0, 0, 0, 0)


class PlantValues:
    """Parameters of the FMU of an axis by the names of `record/plant_values.csv`, SI units.

    Those of one that turns are given as a slide has them that moves by `arm_m` per radian: its
    positions and forces are.
    """

    def __init__(self, plant: PlantRecord, arm_m: float | None = None) -> None:
        self._values, self.arm_m = plant.values, arm_m

    def get(self, *names: str) -> float | None:
        """Return the first one that the FMU has, None without any."""
        for name in names:
            found = self._values.get(name)
            if found is not None:
                if self.arm_m is None or found.exponents is None:
                    return found.value
                return found.value * self.arm_m ** power_of_arm(found.exponents)
        return None

    def number(self, *names: str, otherwise: float = 0.0) -> float:
        """Return the first one that the FMU has, else a value that does nothing."""
        value = self.get(*names)
        return otherwise if value is None else value


def power_of_arm(exponents: tuple[int, ...]) -> int:
    """Return the power of the arm r that makes a quantity of a rotation one of a slide.

    x = r phi, F = M/r, and of them k = K/r^2, m = J/r^2, d = D/r^2; a J does not name the rad of
    its N.m/(rad/s2).
    """
    kg, m, *_, rad = exponents
    if exponents == _INERTIA:
        return -2
    return rad - 1 if (kg, m) == (1, 2) else rad
