"""What the recording has of what was asked of a control, as the rules of what acts want it."""

from collections.abc import Iterator, Mapping
from itertools import pairwise

from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.oracles.distance.acting import NC, SWITCHES_ON, Order
from axisrig.bench.oracles.distance.lists import PER_MM
from axisrig.bench.record.distance import (
    ChannelDistanceRecord,
    Controller,
    DistanceChange,
    DistanceRecord,
)
from axisrig.kernel.time.clock import TimeNs

Record = DistanceRecord | ChannelDistanceRecord
_COMMANDS = {
    "ACTIVE": SWITCHES_ON[0],
    "ACTIVE_CONST_DIST": SWITCHES_ON[1],
    "FREEZE": "FREEZE",
}


def orders_of(observed: Observed, record: Record) -> list[Order]:
    """Return what was asked of a control; of an older recording as far as its changes show it."""
    if record.orders is None:
        return list(_by_changes(observed, record.changes))
    return [
        Order(row_of(observed, one.time_ns), one.by, one.action, one.is_dry_run, one.words)
        for one in record.orders
    ]


def set_by_program(observed: Observed, record: Record) -> dict[str, dict[int, float | None]]:
    """Return the rows in which the program gave SET_POS or SET_DIST, by their columns.

    Each with what the PLC side gave in the same cycle, None without.
    """
    found: dict[str, dict[int, float | None]] = {}
    for column in ("set_pos_mm", "set_dist_mm"):
        rows, by_plc = found.setdefault(column, {}), dict[int, float]()
        for one in record.orders or ():
            value, row = getattr(one, column), row_of(observed, one.time_ns)
            if value is not None and one.by == NC:
                rows[row] = by_plc.get(row)
            elif value is not None:
                by_plc[row] = value
    return found


def row_of(observed: Observed, time_ns: TimeNs) -> int:
    """Return the row of the cycle that an instant belongs to."""
    period_ns = observed.facts.timing.period_ns
    return observed.index_at(time_ns - time_ns % period_ns + period_ns - 1)


def _by_changes(observed: Observed, changes: tuple[DistanceChange, ...]) -> Iterator[Order]:
    for before, now in pairwise((None, *changes)):
        assert now is not None
        row, words = row_of(observed, now.time_ns), {}
        if before is not None and now.controller != before.controller:
            old, new = _words(before.controller), _words(now.controller)
            words = {name: value for name, value in new.items() if value != old[name]}
        action = _COMMANDS.get(now.state, "OFF")
        is_same = before is not None and before.state == now.state
        if is_same and before is not None and before.is_dry_run == now.is_dry_run:
            action, by = "", NC
        else:
            by = now.by
        yield Order(row, by, action, now.is_dry_run, words)


def _words(controller: Controller) -> Mapping[str, object]:
    return {
        "kp": controller.kp,
        "i_tn": controller.tn_s,
        "d_tv": controller.tv_s,
        "filter_type": controller.filter_type,
        "n_cycles": controller.count,
        "smoothing_factor": controller.alpha,
        "low_pass_filter_order": controller.order,
        "low_pass_filter_fg_f0": controller.corner_hz,
        "kalman_sigma": controller.sigma_mm * PER_MM,
        "mode_dist_use_both_encoder": controller.both_encoders,
    }
