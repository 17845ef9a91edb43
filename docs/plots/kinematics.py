"""Side views of the head (kinematic 9) and the robot (45), and the extended tool (98).

`python docs/plots/kinematics.py` draws docs/images/kinematics.svg. The points are those of the
chains of matrices of `bench/axisrig/bench/oracles/kinematics`.
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT))

from axisrig.bench.oracles.kinematics.chain import Chain, X, Y, shift, turn  # noqa: E402

TOOL_MM = 80.0
LINK, BEAM, FLOOR = "#2b4a6f", "#c0392b", "#888888"
# Of kinematic 98: tilt from which and up to which the height is kept, and the largest one
START_DEG, END_DEG, LARGEST_DEG = 30.0, 60.0, 91.0


def points(frames: Sequence[Any], plane: tuple[int, int]) -> Any:
    """Where each link of a chain begins, in two of the machine's coordinates (n, 2)."""
    place = np.eye(4)
    found = [place[:3, 3]]
    for frame in frames:
        place = place @ frame
        found.append(place[:3, 3])
    return np.array(found)[:, plane]


def _link(axes: Any, start: Any, end: Any, name: str, colour: str = LINK) -> None:
    axes.plot(*zip(start, end, strict=True), color=colour, lw=2.5, solid_capstyle="round")
    middle = (np.asarray(start) + end) / 2
    level = abs(end[1] - start[1]) < 1e-9
    away = (-12, -13) if level else (8, -4)
    axes.annotate(name, middle, xytext=away, textcoords="offset points", color=colour)


def _joint(axes: Any, place: Any, name: str, side: int = 8) -> None:
    axes.plot(*place, "o", color="white", mec=LINK, mew=1.5, ms=6)
    align = "left" if side > 0 else "right"
    axes.annotate(name, place, xytext=(side, 4), textcoords="offset points", ha=align)


def draw_head(axes: Any) -> None:
    """Kinematic 9 from +X: Y to the right, A at -35 degrees leans to +Y."""
    chain = [
        shift(0, 0, 230),
        shift(0, 0, -50),
        turn(X, -35.0) @ shift(0, 0, -100),
        shift(0, 0, -TOOL_MM),
    ]
    _, reference, pivot, clamp, tcp = points(chain, (1, 2))
    _link(axes, reference, pivot, "HD2")
    _link(axes, pivot, clamp, "HD1")
    _link(axes, clamp, tcp, "L", BEAM)
    _joint(axes, reference, "X Y Z, axis of C", -8)
    _joint(axes, pivot, "axis of A", -8)
    _joint(axes, clamp, "clamping point", -8)
    axes.annotate("TCP", tcp, xytext=(6, -10), textcoords="offset points")
    u = (clamp - tcp) / TOOL_MM
    axes.annotate("", tcp + 30 * u, tcp, arrowprops={"arrowstyle": "->", "color": "black"})
    axes.annotate("u", tcp + 32 * u, xytext=(-12, 0), textcoords="offset points")
    axes.axhline(tcp[1], color=FLOOR, lw=0.8)
    axes.set(title="9: A = -35, seen from +X", xlabel="Y [mm]", ylabel="Z [mm]", aspect="equal")
    axes.set(xlim=(-150, 60), ylim=(10, 250))


def draw_robot(axes: Any) -> None:
    """Kinematic 45 from -Y in the pose 0 0 0 0 90 0: the tool straight down."""
    chain = [
        shift(0, 0, 400),
        shift(100, 0, 0),
        shift(0, 0, 500),
        shift(0, 0, -50),
        shift(600, 0, 0),
        turn(Y, 90.0) @ shift(80, 0, 0),
        shift(120, 0, 0),
    ]
    foot, waist, shoulder, elbow, bend, wrist, flange, tcp = points(chain, (0, 2))
    names = ("HD7", "HD11", "HD8", "HD12", "HD9", "HD10")
    places = (foot, waist, shoulder, elbow, bend, wrist, flange)
    for name, start, end in zip(names, places[:-1], places[1:], strict=True):
        _link(axes, start, end, name)
    _link(axes, flange, tcp, "HD1 + L", BEAM)
    _joint(axes, foot, "C1", 8)
    _joint(axes, shoulder, "B1")
    _joint(axes, elbow, "B2")
    _joint(axes, (bend + wrist) / 2, "A1", -4)
    _joint(axes, wrist, "B3")
    _joint(axes, flange, "A2", -8)
    axes.annotate("TCP", tcp, xytext=(6, -8), textcoords="offset points")
    axes.set(title="45: 0 0 0 0 90 0, seen from -Y", xlabel="X [mm]", aspect="equal")
    axes.set(xlim=(-60, 900), ylim=(-40, 1000))


def draw_extension(axes: Any) -> None:
    """Length of the tool and height of the clamping point over the tilt, [30; 60]."""
    tilt = np.linspace(0.0, 90.0, 181)
    program = {
        (1, 98, 1): 1e4 * START_DEG,
        (1, 98, 2): 1e4 * END_DEG,
        (1, 98, 3): 1e4 * LARGEST_DEG,
    }
    chain = Chain((9, 98), {}, program, TOOL_MM)
    machine = np.zeros((tilt.size, 5))
    machine[:, 4] = tilt
    frames = chain.frame(machine)
    heights = chain.clamp_mm(machine)[:, 2] - frames[:, 2, 3]
    axes.plot(tilt, chain.length_mm(frames), color=BEAM, label="L2")
    axes.plot(tilt, heights, color=LINK, label="height of the clamping point")
    for limit, name in ((START_DEG, "HD2"), (END_DEG, "HD3")):
        axes.axvline(limit, color=FLOOR, lw=0.8, ls=":")
        axes.annotate(name, (limit, 4), xytext=(3, 0), textcoords="offset points")
    axes.set(title="98: [30; 60], L1 = 80 mm", xlabel="tilt [deg]", ylabel="mm", ylim=(0, 175))
    axes.legend(loc="upper left", frameon=False)


def draw(target: Path) -> Path:
    """Draw the picture; return where it is."""
    import matplotlib as mpl  # noqa: PLC0415
    from matplotlib import pyplot as plt  # noqa: PLC0415

    mpl.use("svg")
    mpl.rcParams.update({"svg.hashsalt": "axisrig", "svg.fonttype": "none", "font.size": 9})
    figure, (head, robot, extension) = plt.subplots(
        1, 3, figsize=(10.5, 4.2), layout="constrained", width_ratios=(3, 4, 4)
    )
    draw_head(head)
    draw_robot(robot)
    draw_extension(extension)
    figure.savefig(target, metadata={"Date": None})
    plt.close(figure)
    return target


if __name__ == "__main__":
    print(draw(HERE.parent / "images" / "kinematics.svg"))
