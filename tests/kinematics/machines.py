"""Machines of the tests: lists with every offset in use, and the range of each axis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from axisrig.bench.oracles.kinematics.chain import Chain
from axisrig.kernel.kinematics import Kinematic, KinematicData, build
from axisrig.kernel.parameters import Origin, ParameterSet

Array = npt.NDArray[np.float64]


def values(text: str) -> dict[str, str]:
    """Parameter and value of each line of a list."""
    return dict(line.split() for line in text.splitlines())


def params(prefix: str, hd: Sequence[float]) -> str:
    """Lines with HD1, HD2, ... in mm and degrees."""
    return "\n".join(f"{prefix}param[{k}] {round(1e4 * value)}" for k, value in enumerate(hd))


@dataclass(frozen=True)
class MachineLists:
    """ids: as a program chooses them. text: the list of the channel. low, high: of the axes."""

    ids: tuple[int, ...]
    text: str
    low: tuple[float, ...]
    high: tuple[float, ...]
    tool_mm: float = 80.0
    program: Mapping[tuple[int, ...], float] = field(default_factory=dict)

    def kernel(self) -> Kinematic:
        channel = ParameterSet("channel")
        for path, value in values(self.text).items():
            channel.load(path, value, Origin("channel.lst", 1))
        return build(self.ids, KinematicData.read(channel), self.program, self.tool_mm)

    def oracle(self) -> Chain:
        return Chain(self.ids, values(self.text), self.program, self.tool_mm)

    def axes(self, count: int, seed: int = 1) -> Array:
        """Axis positions of shape (count, number of axes), seeded."""
        return np.random.default_rng(seed).uniform(self.low, self.high, (count, len(self.low)))


HEAD = params("trafo[0].", (33.5, 61.5, 1.25, -2.5, -24.5, 5.4, 7.0, -8.0, -15.0))
ROBOT_HD = (
    *(45.0, 20.0, -15.0, 10.0, -25.0, 35.0),
    *(450.0, 600.0, 640.0, 115.0, 150.0, 35.0, 0.0, 5.0, -4.0),
)
ROBOT = params("trafo[1].", ROBOT_HD)
UNIVERSAL = """trafo[2].id 91
trafo[2].zero_orientation[0] 0
trafo[2].zero_orientation[1] 0
trafo[2].zero_orientation[2] 1
trafo[2].zero_position[0] 54000
trafo[2].zero_position[1] -395000
trafo[2].zero_position[2] -950000
trafo[2].number_of_axes 5
trafo[2].axis[0].type 1
trafo[2].axis[0].orientation[0] 1
trafo[2].axis[1].type 1
trafo[2].axis[1].orientation[1] 1
trafo[2].axis[2].type 1
trafo[2].axis[2].orientation[2] 1
trafo[2].axis[3].type 2
trafo[2].axis[3].orientation[2] 1
trafo[2].axis[4].type 2
trafo[2].axis[4].orientation[0] 1
trafo[2].axis[4].point[0] 54000
trafo[2].axis[4].point[1] -245000
trafo[2].axis[4].point[2] -615000
trafo[2].rtcp 1"""
# The table with A and C under the workpiece and axes that are not at right angles
TABLE = """trafo[0].id 91
trafo[0].zero_orientation[0] 0.1
trafo[0].zero_orientation[1] -0.2
trafo[0].zero_orientation[2] 2
trafo[0].zero_position[0] 12000
trafo[0].zero_position[1] -32000
trafo[0].zero_position[2] 5000
trafo[0].number_of_axes 6
trafo[0].axis[0].type 1
trafo[0].axis[0].orientation[0] 1
trafo[0].axis[0].orientation[1] 0.01
trafo[0].axis[1].type 1
trafo[0].axis[1].orientation[1] 2
trafo[0].axis[2].type 1
trafo[0].axis[2].orientation[0] 0.02
trafo[0].axis[2].orientation[2] 1
trafo[0].axis[3].type 2
trafo[0].axis[3].orientation[0] -1
trafo[0].axis[3].point[2] 700000
trafo[0].axis[4].type 2
trafo[0].axis[4].orientation[2] -1
trafo[0].axis[4].orientation[1] 0.05
trafo[0].axis[4].point[0] 300000
trafo[0].axis[5].type 2
trafo[0].axis[5].orientation[1] 1
trafo[0].axis[5].point[0] 100000
trafo[0].chain[0] 4
trafo[0].chain[1] 3
trafo[0].chain[2] 0
trafo[0].chain[3] 2
trafo[0].chain[4] 1
trafo[0].chain[5] 5
trafo[0].rtcp 1"""
SLIDE = """trafo[2].id 3
trafo[2].type 91
trafo[2].name LINEAR
trafo[2].zero_orientation[0] 0.1
trafo[2].zero_orientation[2] 1
trafo[2].zero_position[0] 20000
trafo[2].zero_position[2] 50000
trafo[2].number_of_axes 1
trafo[2].axis[0].type 1
trafo[2].axis[0].orientation[0] 3
trafo[2].axis[0].orientation[1] 0.3
trafo[2].base[2] -100000
trafo[2].base[5] 150000"""
SLIDES = (
    SLIDE.replace("number_of_axes 1", "number_of_axes 2")
    + """
trafo[2].axis[1].type 1
trafo[2].axis[1].orientation[1] 1
trafo[2].axis[1].orientation[0] 0.2"""
)
COUPLING = f"""trafo[0].id 210
trafo[0].group[0].id 100
trafo[0].group[0].chain[0] LINEAR
trafo[0].group[0].chain[1] 2
{SLIDE}
trafo[1].id 2
trafo[1].type 45
trafo[1].base[0] 100000
trafo[1].base[2] -1000000
trafo[1].base[3] 100000
trafo[1].base[5] 900000
{ROBOT}"""
SLIDE_FIRST = "\ntrafo[0].group[0].move_prio[0] 3\ntrafo[0].group[0].move_prio[1] 2"
ROBOT_FIRST = "\ntrafo[0].group[0].move_prio[0] 2\ntrafo[0].group[0].move_prio[1] LINEAR"
TILTS = {(1, 98, 0): 1e6, (1, 98, 1): 3e5, (1, 98, 2): 6e5, (1, 98, 3): 1.8e6}

HEAD_LOW, HEAD_HIGH = (-500, -500, -500, -360, -120), (500, 500, 500, 360, 120)
JOINTS_LOW, JOINTS_HIGH = (-180, -90, -120, -270, -130, -360), (180, 120, 100, 270, 130, 360)

MACHINES = {
    "9": MachineLists((9,), f"trafo[0].id 9\n{HEAD}", HEAD_LOW, HEAD_HIGH),
    "9, 98": MachineLists((9, 98), f"trafo[0].id 9\n{HEAD}", HEAD_LOW, HEAD_HIGH, program=TILTS),
    "45": MachineLists((45,), f"trafo[1].id 45\n{ROBOT}", JOINTS_LOW, JOINTS_HIGH),
    "45, 98": MachineLists(
        (45, 98), f"trafo[1].id 45\n{ROBOT}", JOINTS_LOW, JOINTS_HIGH, program=TILTS
    ),
    "91": MachineLists((91,), UNIVERSAL, HEAD_LOW, HEAD_HIGH),
    "91 table": MachineLists((91,), TABLE, (*HEAD_LOW, -90), (*HEAD_HIGH, 90)),
    "210 slide first": MachineLists(
        (210,), COUPLING + SLIDE_FIRST, (*JOINTS_LOW, -900), (*JOINTS_HIGH, 900)
    ),
    "210 robot first": MachineLists(
        (210,), COUPLING + ROBOT_FIRST, (*JOINTS_LOW, -900), (*JOINTS_HIGH, 900)
    ),
    "210 two slides": MachineLists(
        (210,),
        COUPLING.replace(SLIDE, SLIDES) + SLIDE_FIRST,
        (*JOINTS_LOW, -900, -900),
        (*JOINTS_HIGH, 900, 900),
    ),
}
