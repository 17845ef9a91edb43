"""What follows for a row of testplans/distance_3d.csv, from formulas written out here.

Nothing of the bench is imported. Lengths in mm, angles in degrees, times in s. u is the unit vector
from the tool centre point to the clamping point, u = Rz(C) Rx(A) e_z; the lever of the head has 100
mm from the A axis to the clamping point and 80 mm of tool (docs/kinematics.md).
q delays by one cycle of T; an offset of cycle k is seen again in cycle k + n + 1.
"""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

PERIOD_S, TOOL_MM, HEAD_MM, LEVER_MM = 1e-3, 80.0, 100.0, 180.0
LINEAR_MM, ROTARY_DEG = 1e-5, 1e-4
"""Increments of the encoders of rigs/distance-5axis.toml."""
VARIABLE_UM = 0.1
"""Of the sensor variable: one of its units."""
Vector = npt.NDArray[np.float64]


def cos(deg: float) -> float:
    """Cosine of an angle in degrees."""
    return math.cos(math.radians(deg))


def sin(deg: float) -> float:
    """Sine of an angle in degrees."""
    return math.sin(math.radians(deg))


def tan(deg: float) -> float:
    """Tangent of an angle in degrees."""
    return math.tan(math.radians(deg))


def direction(c: float, a: float) -> Vector:
    """Return u."""
    turned: Vector = Rotation.from_euler("ZX", [c, a], degrees=True).apply([0.0, 0.0, 1.0])
    return turned


def start(c: float, a: float, tcp: Sequence[float] = (0.0, 0.0, 0.0)) -> Vector:
    """Return X, Y, Z with the tool centre point there and a tool that is not extended."""
    return np.asarray(tcp) + LEVER_MM * direction(c, a)


def extended(tilt: float, hd2: float, hd3: float, length: float = TOOL_MM) -> float:
    """Return the virtual length of kinematic 98; HD2 from 90 degrees on: never extended."""
    if hd2 >= 90 or tilt <= hd2:
        return length
    return length * cos(hd2) / cos(min(tilt, hd3))


def along_tool(deviation: float, c: float, a: float) -> Vector:
    """Return the way of the tool for a deviation along Z that is compensated along the tool."""
    return deviation / cos(a) * direction(c, a)


def inclined(tilt: float, slope: float) -> float:
    """Return by what the gain of the loop grows over a surface inclined in the plane of the tilt.

    The tool goes o/cos b along u, and u makes an angle of b - p with the normal of the surface.
    """
    return cos(tilt - slope) / cos(tilt)


def growth(gain: float, dead: int) -> float:
    """Return the largest pole of CONST_DIST without filter: z^(n+1) - z^n + K = 0."""
    return float(np.abs(np.roots([1.0, -1.0, *[0.0] * (dead - 1), gain])).max())


def limit(dead: int) -> float:
    """Return the largest gain with which it is stable: 2 sin(pi/(2 (2n + 1)))."""
    return 2 * math.sin(math.pi / (2 * (2 * dead + 1)))


def overshoot(gain: float, dead: int, height: float) -> float:
    """Return how far the offset goes past a step of the surface: the law, cycle by cycle."""
    offset = [0.0] * 400
    for k in range(1, len(offset)):
        seen = offset[k - dead - 1] if k > dead else 0.0
        offset[k] = offset[k - 1] + gain * (height - seen)
    return max(offset) - height


def following(gain: float, dead: int, hz: float) -> tuple[float, float]:
    """Return amplitude of the tool over that of the surface, and its lag in degrees: L/(1 + L)."""
    q = np.exp(-2j * np.pi * hz * PERIOD_S)
    loop = gain * q ** (dead + 1) / (1 - q)
    answer = complex(loop / (1 + loop))
    return abs(answer), -math.degrees(math.atan2(answer.imag, answer.real))


def held_behind(speed: float, cycles: int, behind: float, acceleration: float) -> float:
    """Return how far SURFACE is behind after so many cycles without a step.

    The surface goes on by v T in each of them, and after them by v T less the step of the offset,
    which grows by a T^2 from cycle to cycle.
    """
    way, growth_mm = speed * PERIOD_S, acceleration * PERIOD_S**2
    found = behind + cycles * way
    step = growth_mm
    while step < way:
        found += way - step
        step += growth_mm
    return found


def sensitivity(gain: float, dead: int, hz: float) -> float:
    """Return |1/(1 + L)|, L = K q^(n+1)/(1 - q)."""
    q = np.exp(-2j * np.pi * hz * PERIOD_S)
    return float(abs(1 / (1 + gain * q ** (dead + 1) / (1 - q))))


def ramp_error(speed: float, kp: float) -> float:
    """Return by how much CONST_DIST is behind a surface that rises evenly: v T/kp."""
    return speed * PERIOD_S / kp


def ramp_behind_surface(speed: float, kp: float, dead: int, mean_of: int = 1) -> float:
    """Return the same of SURFACE: v (T/kp + n T + (N - 1) T/2)."""
    return speed * PERIOD_S * (1 / kp + dead + (mean_of - 1) / 2)


def tilted_error(wrong: float, tilt: float, height: float) -> float:
    """Return the offset of SURFACE with a PLC that takes the tilt for `wrong` more than it is.

    The value is k h with k = cos(b + w)/cos b, and the law rests where z + o - k (z + o) = o with
    the nominal height z of the clamping point above surface and assumed surface: o = z (1 - k)/k.
    """
    k = cos(tilt + wrong) / cos(tilt)
    return height * (1 - k) / k


def tilting_bound(a: float) -> float:
    """Return how far (um) the tool centre point may be from a level surface while it tilts.

    Half an increment of each axis at the place, the same of A in the correction of the PLC, half
    a unit of the variable. In the distance h = d cos b half an increment of A is d sin b times it.
    """
    half = math.radians(ROTARY_DEG / 2)
    of_axes = LEVER_MM * abs(sin(a)) * half + 3 * LINEAR_MM / 2
    of_plc = TOOL_MM * abs(sin(a)) * half
    return (of_axes + of_plc) * 1e3 + VARIABLE_UM / 2


def noise_gain(gain: float, dead: int) -> float:
    """Return the root of the energy of the impulse response from the sensor value to the offset."""
    offset = [0.0] * 4000
    for k in range(1, len(offset)):
        seen = (1.0 if k == 1 else 0.0) - (offset[k - dead - 1] if k > dead else 0.0)
        offset[k] = offset[k - 1] + gain * seen
    return math.sqrt(sum(o * o for o in offset))


def stretch(wrist_x: float, wrist_z: float) -> float:
    """Return how far the wrist of rigs/distance-robot.toml can rise until its arm is straight."""
    reach = 600 + math.hypot(640, 100)
    return math.sqrt(reach**2 - (wrist_x - 150) ** 2) - (wrist_z - 450)
