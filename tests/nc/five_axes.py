"""A machine with the head of kinematic 9, and programs in the coordinates of its tool.

Expected positions are products of scipy's rotations: TCP = pivot - L u with u = Rz(C) Rx(A) e_z.
"""

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation
from tests.nc.conftest import PlaneMachine, run_text

from axisrig.kernel.kinematics import Kinematic
from axisrig.kernel.nc.canon import (
    Command,
    KinematicChoice,
    LinearMove,
    MeasuringRun,
    Message,
)
from axisrig.kernel.nc.coordinates import OffsetTables

FIVE = ("X", "Y", "Z", "C", "A")
TABLES = OffsetTables(rotary=frozenset("CA"))
ON = "V.G.WZ_AKT.L = 80\n#KIN ID[9]\n#TRAFO ON\n"


def direction(c_deg: float, a_deg: float) -> np.ndarray:
    return Rotation.from_euler("ZX", [c_deg, a_deg], degrees=True).apply([0.0, 0.0, 1.0])


def pivot_mm(tcp_mm: Sequence[float], c_deg: float, a_deg: float) -> np.ndarray:
    return np.array(tcp_mm) + 80.0 * direction(c_deg, a_deg)


class FiveAxes(PlaneMachine):
    """Moves in the coordinates of the tool while a kinematic is on; its probe touches at TCP Z."""

    kinematic: Kinematic | None = None

    def execute(self) -> None:
        queue, self.queue = self.queue, []
        for command in queue:
            if isinstance(command, KinematicChoice):
                self.kinematic = command.kinematic
            elif isinstance(command, LinearMove):
                self.go(command.target_mm)
            elif isinstance(command, MeasuringRun):
                tool = self.tool()
                assert self.plane is not None
                share = (tool["Z"] - self.plane[1]) / (tool["Z"] - command.target_mm["Z"])
                self.go(
                    {a: tool[a] + (end - tool[a]) * share for a, end in command.target_mm.items()}
                )
                self.latched = {
                    axis: None if axis in self.silent else self.acs_mm[axis]
                    for axis in command.measuring_axes
                }

    def tool(self) -> dict[str, float]:
        if self.kinematic is None:
            return self.acs_mm
        count = self.kinematic.count
        tool = self.kinematic.forward(tuple(self.acs_mm.values())[:count])
        return {**self.acs_mm, **dict(zip([*self.acs_mm][:count], tool, strict=True))}

    def go(self, target) -> None:
        tool = tuple({**self.tool(), **target}.values())
        if self.kinematic is not None:
            count = self.kinematic.count
            tool = (*self.kinematic.inverse(tool[:count], tool[:count]), *tool[count:])
        self.acs_mm = dict(zip(self.acs_mm, tool, strict=True))


def machine(**options) -> FiveAxes:
    return FiveAxes(
        dict(zip(FIVE, (10.0, 20.0, 200.0, 0.0, 0.0), strict=True)), **{"plane": None, **options}
    )


def run5(text: str, at: FiveAxes | None = None, tables: OffsetTables = TABLES) -> list[Command]:
    return run_text(text, at or machine(), axes=FIVE, tables=tables)


def printed(commands: Sequence[Command]) -> list[float]:
    return [number for c in commands if isinstance(c, Message) for number in c.values]
