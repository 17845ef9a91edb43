"""Where a probe touches: the normal of the surface, the seat of the stylus, how both yield.

Closed forms of what a surface and a stylus do until the probe switches, from the start values.
"""

from collections.abc import Mapping
from math import cos, pi, sin

from axisrig.bench.rig.settings import Settings
from axisrig.bench.tools.budget.starts import start_number, start_value

Vector = tuple[float, float, float]

LENGTH_M, RADIUS_M, BENDING_N_M, AXIAL_N_M = 50e-3, 10e-3, 0.2e6, 2e6
"""Defaults of stylus_length, seat_radius, bending_stiffness, axial_stiffness (WorkpieceProbe)."""
_FAR_M = 1e3
_BENT = (
    *("workpiece.inclined.angle", "workpiece.ramp.rise", "workpiece.step.rise"),
    *("workpiece.sine.amplitude", "workpiece.cylinder.radius", "workpiece.hole.radius"),
)
_WALL = "workpiece.border.position"


def normal_of(settings: Settings, probe: str) -> Vector | None:
    """Return the normal of the plane that a probe touches, towards free space.

    None where the surface is no plane: then it depends on where it is touched. A wall that is in
    reach is what is touched: a probe for walls has its workpiece out of reach below it.
    """
    if any(start_value(settings, probe, f"normal_{name}") for name in "xyz"):
        x, y = (start_number(settings, probe, f"normal_{name}", 0.0) for name in "xy")
        return x, y, start_number(settings, probe, "normal_z", 1.0)
    waves = [f"workpiece.waviness.amplitude[{number}]" for number in range(1, 5)]
    if any(start_number(settings, probe, key, 0.0) for key in (*_BENT, *waves)):
        return None
    if start_number(settings, probe, _WALL, _FAR_M) == _FAR_M:
        return 0.0, 0.0, 1.0
    azimuth = start_number(settings, probe, "workpiece.border.azimuth", 0.0)
    return cos(azimuth), sin(azimuth), 0.0


def way_per_length(normal: Vector, velocity: Mapping[str, float], axis: str) -> float | None:
    """Return how far an axis moves until a probe is deflected by a length along a normal.

    velocity: true velocity of the coordinates x, y, z. Moving with v, the distance from the
    surface falls by -n.v: a deflection p takes p/(-n.v), in which the axis moves v_axis of it.
    """
    towards = -sum(velocity.get(name, 0.0) * part for name, part in zip("xyz", normal, strict=True))
    return velocity[axis] / towards if towards > 0.0 else None


def trigger_force_n(settings: Settings, probe: str, normal: Vector) -> float:
    """Return the force along the normal at which the first of three pads is without load.

    F = F_p/(n_z + 2 L/R max_i(n_x cos phi_i + n_y sin phi_i)), pads 120 degrees apart: moments
    about the line through the other two pads (W. T. Estler et al., Precision Engineering 19, 1996).
    """
    force_n = start_number(settings, probe, "seat_force", 0.0)
    lever = 2 * start_number(settings, probe, "stylus_length", LENGTH_M)
    lever /= start_number(settings, probe, "seat_radius", RADIUS_M)
    first = start_number(settings, probe, "seat_angle", 0.0)
    x, y, z = normal
    towards_pad = max(
        x * cos(first + turn) + y * sin(first + turn) for turn in (0.0, 2 * pi / 3, -2 * pi / 3)
    )
    return force_n / max(1e-3, z + lever * towards_pad)


def seat_um(settings: Settings, probe: str, normal: Vector) -> float:
    """Return by how much the stylus yields until the probe switches: force over stiffness."""
    x, y, z = normal
    bending_n_m = start_number(settings, probe, "bending_stiffness", BENDING_N_M)
    axial_n_m = start_number(settings, probe, "axial_stiffness", AXIAL_N_M)
    yields = (x * x + y * y) / bending_n_m + z * z / axial_n_m
    return trigger_force_n(settings, probe, normal) * yields * 1e6


def contact_um(settings: Settings, probe: str, normal: Vector) -> float:
    """Return by how much ball and workpiece yield where they touch, at the trigger force.

    Hertz, ball on a flat body: contact radius a = (3 F r/(4 E))^(1/3), approach a^2/r (K. L.
    Johnson, Contact Mechanics, 1985, 4.2), E the reduced modulus.
    """
    modulus_n_m2 = start_number(settings, probe, "contact_modulus", 0.0)
    radius_m = start_number(settings, probe, "ball_radius", 0.0)
    force_n = trigger_force_n(settings, probe, normal)
    if not (modulus_n_m2 and radius_m and force_n):
        return 0.0
    contact_radius_m: float = (0.75 * force_n * radius_m / modulus_n_m2) ** (1 / 3)
    return contact_radius_m**2 / radius_m * 1e6
