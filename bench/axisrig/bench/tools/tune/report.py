"""What `axisrig tune distance` says: as text, as data, and as warnings."""

from collections.abc import Iterator
from textwrap import wrap
from typing import Any

from axisrig.bench.tools.tune.advice import KP_MAX, Advice, cycles_in_words
from axisrig.bench.tools.tune.distance import CONST_DIST, Configured, DeadTime, Mode, Tuning
from axisrig.bench.tools.tune.identify import Path
from axisrig.bench.tools.tune.loop import Law
from axisrig.kernel.distance.filters import filter_kinds

_GAIN_ERROR, _MARGIN, _MISFIT = 0.02, 1.5, 0.01
_WIDTH, _INDENT = 100, " " * 14
_WORDS = {
    "n_cycles": "{} values",
    "smoothing_factor": "smoothing factor {:g}",
    "kalman_sigma": "sigma {:g}",
    "low_pass_filter_order": "order {}",
    "low_pass_filter_fg_f0": "{:g} Hz",
}


def text_of(found: Tuning) -> str:
    """Say everything, in lines of a terminal."""
    bench = found.bench
    sensor = f"variable {bench.variable}" if bench.variable else "second encoder (60E4)"
    lines = [
        f"axis {bench.axis} of {bench.rig}: {sensor}, cycle {found.period_s * 1e3:g} ms",
        f"measured with steps of {found.step_mm * 1e3:.4g} um at a distance of"
        f" {found.rest_mm:.4f} mm; noise of the sensor {found.distance.sigma_mm * 1e3:.3g} um",
        "",
        *_dead_time(found.dead_time, found.distance, found.period_s),
        f"filter        {filter_in_words(found.configured)}",
    ]
    for mode in found.modes:
        lines += ["", *_mode(found, mode)]
    if found.trial is not None:
        passed, misfit_um = found.trial.predicted.max() - 1, found.trial.misfit_mm * 1e3
        lines += [
            "",
            f"tried         {_law(found.trial.law)} in {found.chosen.name}:",
            f"              passes a step by {max(passed, 0):.1%} as predicted, within"
            f" {misfit_um:.2g} um",
        ]
    return "\n".join(lines)


def filter_in_words(configured: Configured) -> str:
    """Name the filter with the parameters that act on it."""
    kind = filter_kinds()[configured.filter.kind]
    values = [_WORDS[name].format(getattr(configured.filter, name)) for name in kind.parameters]
    return f"{kind.ident}, {', '.join(values)}"


def _dead_time(dead: DeadTime, distance: Path, period_s: float) -> Iterator[str]:
    ms = period_s * 1e3
    when = f"{cycles_in_words(dead.reaction)} later" if dead.reaction else "in its own cycle"
    yield (
        f"dead time     n = {cycles_in_words(dead.dead)}: an offset is sent {when} and is seen"
        f" {cycles_in_words(dead.way)} after that{' at the latest' if dead.renewal > 1 else ''}"
    )
    if dead.way_ns is not None:
        yield f"              frames: {dead.way_ns / 1e6:.3f} ms from set position to sensor value"
    if dead.renewal > 1:
        yield f"              the value is new every {dead.renewal} cycles; the oldest counts"
    if not distance.is_dead_time:
        yield (
            f"              the answer takes longer: 98 % after {distance.settled_cycle} cycles,"
            f" centre {distance.mean_cycle:.1f} cycles ({distance.mean_cycle * ms:.1f} ms)"
        )


def _mode(found: Tuning, mode: Mode) -> Iterator[str]:
    law = found.configured.law
    state = "stable" if mode.is_stable else "UNSTABLE"
    yield mode.name + (" (chosen by the list)" if mode is found.chosen else "")
    low, high = mode.stable_kp
    from_kp = f"{low:.4g} < " if low else ""
    text = f"  stable for  {from_kp}kp < {high:.4g}" if high else "  stable for  no kp"
    if mode.closed_limit is not None and not law.tn_s and not law.tv_s:
        text += f"; closed form {mode.closed_limit:.4g}"
    yield text
    yield f"  configured  {_law(law)}: {state}"
    advice = mode.advice
    if advice is None:
        yield "  suggested   nothing: no kp keeps this loop stable"
        return
    yield f"  suggested   {_law(advice.law)}"
    if mode.name == CONST_DIST:
        error_um = found.period_s / advice.law.kp * 1e3
        yield f"              error on a slope {error_um:.3g} um for each mm/s of rise"
    noise = advice.quality.noise_gain
    yield f"              noise of the offset {noise:.2g} times that of the sensor"
    for reason in advice.reasons:
        yield from wrap(reason, _WIDTH, initial_indent=_INDENT, subsequent_indent=_INDENT + "  ")


def _law(law: Law) -> str:
    return f"kp {law.kp:g}, i_tn {law.tn_s:g} s, d_tv {law.tv_s:g} s"


def warnings_of(found: Tuning) -> Iterator[str]:
    """Give what the user must read before the control is switched on."""
    law, filtered = found.configured.law, filter_in_words(found.configured)
    for mode in found.modes:
        if mode.is_stable or (mode is not found.chosen and mode.name.startswith("CONST_DIST")):
            continue
        limit = mode.stable_kp[1]
        bound = f"only kp below {limit:.3g} is stable" if limit else "no kp is stable"
        yield (
            f"{mode.name} with {_law(law)} and filter {filtered} is unstable with"
            f" {cycles_in_words(found.dead_time.dead)} of dead time: {bound}. The offset will swing"
            f" ever higher, until an alarm ends it (70331, 70330).{_remedy(mode.advice)}"
        )
    mode = found.chosen
    if mode.is_stable and mode.stable_kp[1] < _MARGIN * law.kp < KP_MAX:
        share = mode.stable_kp[1] / law.kp
        yield (
            f"{mode.name} with {_law(law)} is stable, but only {share:.2f} times below the limit:"
            f" it will ring.{_remedy(mode.advice)}"
        )
    if abs(found.distance.gain - 1) > _GAIN_ERROR:
        yield (
            f"1 mm of offset changes the distance by {found.distance.gain:.3f} mm: look at the"
            " resolution of the sensor (P-AXIS-00422, 00423), or the answer was not over"
        )
    sigma_mm, misfit_mm = found.distance.sigma_mm, found.distance.misfit_mm
    if misfit_mm > max(_MISFIT * found.step_mm, 2 * sigma_mm):
        yield (
            f"the answer of the axis is not linear by {misfit_mm * 1e3:.2g} um (friction, backlash,"
            " limits of the drive): figures are rough; another --step shows how much"
        )
    if sigma_mm and found.step_mm < 50 * sigma_mm:
        yield (
            f"the step is only {found.step_mm / sigma_mm:.0f} times the noise of the sensor; --step"
            " makes it greater"
        )


def _remedy(advice: Advice | None) -> str:
    if advice is None:
        return " A shorter filter or less dead time would help."
    return f" Set {_law(advice.law)}."


def data_of(found: Tuning) -> dict[str, Any]:
    """Give the findings for machines; units end the names."""
    return {
        "axis": found.bench.axis,
        "rig": str(found.bench.rig),
        "variable": found.bench.variable,
        "period_s": found.period_s,
        "step_mm": found.step_mm,
        "noise_mm": found.distance.sigma_mm,
        "filter": filter_in_words(found.configured),
        "dead_cycles": found.dead_time.dead,
        "reaction_cycles": found.dead_time.reaction,
        "way_cycles": found.dead_time.way,
        "way_ns": found.dead_time.way_ns,
        "renewal_cycles": found.dead_time.renewal,
        "answer": {
            "is_dead_time": found.distance.is_dead_time,
            "settled_cycles": found.distance.settled_cycle,
            "mean_cycles": found.distance.mean_cycle,
            "gain": found.distance.gain,
        },
        "modes": [_mode_data(found, mode) for mode in found.modes],
        "warnings": list(warnings_of(found)),
    }


def _mode_data(found: Tuning, mode: Mode) -> dict[str, Any]:
    advice = mode.advice
    return {
        "name": mode.name,
        "is_chosen": mode is found.chosen,
        "configured": _law_data(found.configured.law),
        "is_stable": mode.is_stable,
        "stable_kp": list(mode.stable_kp),
        "closed_form_kp": mode.closed_limit,
        "suggested": None if advice is None else _law_data(advice.law),
        "reasons": [] if advice is None else list(advice.reasons),
    }


def _law_data(law: Law) -> dict[str, float]:
    return {"kp": law.kp, "i_tn_s": law.tn_s, "d_tv_s": law.tv_s}
