"""Which signs converge: mode x P-AXIS-00230 x direction in which the sensor counts.

The control needs a sensor value that gets smaller when the tool lifts (FCT-M3 5). A sensor that
gives the gap counts with the motor and needs P-AXIS-00230 = 1; one that counts against it needs 0.
Every other combination feeds the offset back with the wrong sign: the error grows by 1 + kp in a
loop without dead time until the sensor or the offset is at its limit.
"""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from axisrig.bench.oracles.distance.loop import BOTH, CONST_DIST, SET_POS
from axisrig.bench.oracles.distance.model import Law, Rig, simulate
from axisrig.bench.oracles.distance.supervision import Due, changes_mm, first_due


@dataclass(frozen=True)
class Signs:
    """One combination. inverts: P-AXIS-00230. tells_gap: the sensor counts with the motor."""

    mode: str
    inverts: bool
    tells_gap: bool

    @property
    def converges(self) -> bool:
        """Whether it is a documented combination."""
        return self.inverts == self.tells_gap

    @property
    def sign(self) -> int:
        """For `model.Rig` and `loop.Loop`."""
        return 1 if self.converges else -1


TABLE = tuple(
    Signs(mode, inverts, tells_gap)
    for mode, inverts, tells_gap in product(
        (SET_POS, CONST_DIST, BOTH), (False, True), (False, True)
    )
)


def predicted(
    signs: Signs, law: Law, rig: Rig, gap_mm: float, set_mm: float, cycles: int = 20000
) -> Due | None:
    """Return alarm and cycle (0 = first of the control) over a level surface, by the model.

    law: fresh, in the mode of the combination. gap_mm: height of the tool above the surface,
    that is at height 0. None: it converges.
    """
    course = simulate(law, replace(rig, sign=signs.sign), np.zeros(cycles), gap_mm, set_mm)
    watched = np.ones(cycles, dtype=bool)
    sensor = course.sensor_mm
    change = changes_mm(sensor)
    return first_due(sensor, change, course.asked_mm, watched, law.limits, law.period_ns)
