"""The diagnosis data of 3D distance control with their names (FCT-M3 12.10).

Lengths and v_max in 0.1 um and 0.1 um/s, a_max in mm/s2, max_dist_change in um per cycle. Figure 56
proves this for cycles of 1 ms (docs/ambiguities.md).
"""

from typing import Final

from axisrig.kernel.channel.distance.channel import ChannelDistance
from axisrig.kernel.channel.distance.guide import MODES
from axisrig.kernel.distance import DistanceState
from axisrig.kernel.parameters.units import UNITS_PER_MM

UM: Final = 1000


def diagnosis(found: ChannelDistance, *, is_awaited: bool) -> tuple[tuple[str, str], ...]:
    """Return names and values, in the order of the manual.

    is_awaited: the program waits until it is completely on or off. sollw: the set value that acts,
    sollw_prog: that of the mode which was programmed last. Modes: OFF(0), ACS(1), ECS(2), MCS(3).
    """
    control, settings = found.control, found.control.settings
    smooth, state = settings.filter, control.state
    is_on = not found.is_idle
    is_constant = state is DistanceState.ACTIVE_CONST_DIST
    set_mm = control.set_dist_mm if is_constant else control.set_pos_mm
    programmed_mm = control.set_pos_mm if control.set_dist_mm is None else control.set_dist_mm
    is_frozen = state is DistanceState.FREEZE or found.is_held
    is_weighted = bool(settings.v_weight_down_permille or settings.a_weight_down_permille)
    guide = found.guide
    active_axis = guide.axes[0] if is_on and guide is not None else None
    return (
        ("zstd", f"{state.name}({int(state)})"),
        ("tast_offset", _length(control.zero_mm)),
        ("referenzwert", _length(found.settings.ref_offset_mm)),
        ("sollw", _length(set_mm)),
        ("sollw_prog", _length(programmed_mm)),
        ("kp", f"{settings.kp:.6f}"),
        ("i_tn", f"{settings.tn_s:.6f}"),
        ("d_tv", f"{settings.tv_s:.6f}"),
        ("filter_type", smooth.kind),
        ("n_cycles", f"{smooth.n_cycles}"),
        ("smooth_fact", f"{smooth.smoothing_factor:.6f}"),
        ("sigma", f"{smooth.kalman_sigma:.6f}"),
        ("max_dist_change", f"{round(settings.max_change_mm_s * found.period_s * UM)}"),
        ("fg_f0", f"{smooth.low_pass_filter_fg_f0:.6f}"),
        ("order", f"{smooth.low_pass_filter_order}"),
        ("v_max", _length(settings.v_max_mm_s)),
        ("a_max", f"{round(settings.a_max_mm_s2)}"),
        ("logged_events", f"{found.logged_events}"),
        ("cmd_offset", _length(control.offset_mm)),
        ("cmd_offset_frozen", _length(control.offset_mm if is_frozen else None)),
        ("act_offset", _length(found.output_mm)),
        ("delta_tool_length", _length(found.lengthening_mm())),
        ("f_freeze", f"{int(is_frozen)}"),
        ("f_wait_for_finished", f"{int(is_awaited)}"),
        ("f_use_weighting", f"{int(is_weighted)}"),
        ("active_mode", _mode(guide.mode if is_on and guide is not None else None)),
        ("new_mode", _mode(found.next_mode)),
        ("active_ax_idx", _index(found, active_axis)),
        ("new_ax_idx", _index(found, found.wanted_axis)),
    )


def _length(value_mm: float | None) -> str:
    return f"{round((value_mm or 0.0) * UNITS_PER_MM)}"


def _mode(mode: str | None) -> str:
    return "OFF(0)" if mode is None else f"{mode}({MODES.index(mode) + 1})"


def _index(found: ChannelDistance, axis: str | None) -> str:
    return "0" if axis is None else f"{found.names.index(axis)}"
