"""An axis whose outputs stand still within its own longer steps has no position at an edge."""

from typing import Final

from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant.axis import PlantAxis
from axisrig.kernel.time.clock import TimeNs

# A step that goes further than at its higher end speed; the share is for a motion that swings in it
_JUMP: Final = 2.0
_ROUNDING_M: Final = 1e-7


def refuse_held_outputs(axis: PlantAxis, begin_ns: TimeNs, end_ns: TimeNs) -> None:
    """Raise PlantError where the last step of an axis, in which an edge came, is none of its own.

    Its position stood still although it has a speed, or jumped further than its speeds allow: the
    FMU steps inside more coarsely than it is asked to, as a container of other FMUs may.
    """
    begin_m, begin_m_s, end_m, end_m_s = axis.tick
    span_s, moved_m = (end_ns - begin_ns) * 1e-9, end_m - begin_m
    highest_m_s = max(abs(begin_m_s), abs(end_m_s))
    is_held = moved_m == 0.0 and begin_m_s == end_m_s and highest_m_s * span_s > _ROUNDING_M
    is_jump = abs(moved_m) > _JUMP * highest_m_s * span_s + _ROUNDING_M
    if is_held or is_jump:
        raise PlantError(
            axis.slave.name,
            end_ns,
            f"its position moved by {moved_m * 1e6:.3g} um in a step of {span_s * 1e6:g} us with an"
            f" edge, at {highest_m_s * 1e3:.3g} mm/s: it steps inside more coarsely than that;"
            " `axisrig fmu check` says how coarsely, set fine_us and exchange_us in [cycle] to it,"
            " or export it with a shorter step",
        )
