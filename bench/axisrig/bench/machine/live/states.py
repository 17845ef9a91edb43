"""The state of a running machine as data: what a commissioning engineer wants to see of it.

Read between two cycles, where nothing changes. Only what the machine has at hand is read; nothing
of it is asked, stepped or drained, so that a run with an onlooker is the run without one.
"""

import json
import math
from collections.abc import Mapping
from typing import Any

from axisrig.bench.bus.paced import PacedScheduler
from axisrig.bench.machine.live.pipe import Outlet
from axisrig.bench.machine.machine import Machine
from axisrig.bench.machine.unfinished_program import at_work, waited_for
from axisrig.bench.oracles.distance.lists import CHANNEL
from axisrig.bench.rig.rotary import is_rotary
from axisrig.kernel.channel import Channel, ChannelState
from axisrig.kernel.channel.distance.sensing import Sensing, source_word
from axisrig.kernel.distance import DistanceState
from axisrig.kernel.drives.interface import Drive
from axisrig.kernel.time.clock import MS, US

TEXT_MAX = 300
LATEST = 5
"""So many alarms and messages are shown, the last ones."""
SYNCS_LOOKED_AT = 500
"""So many SYNCs, the last ones, say how well real time is kept."""
_RUNS_LOOKED_AT = 100

State = dict[str, Any]


class LiveStates:
    """Sends the state of a machine whenever the reader of its pipe asks for one.

    about: what is known of the run besides, such as its id and the row of the plan.
    """

    def __init__(self, pipe: Outlet, about: Mapping[str, Any]) -> None:
        self._pipe, self._about = pipe, dict(about)

    def __call__(self, machine: Machine) -> None:
        """Look at a machine between two of its cycles."""
        if self._pipe.is_asked:
            self._pipe.put(as_json({**self._about, **state_of(machine)}))


def as_json(state: Mapping[str, Any]) -> bytes:
    """Write a state as strict JSON: what is not a finite number is null."""
    return json.dumps(_plain(state), ensure_ascii=False, allow_nan=False).encode()


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(name): _plain(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value[:TEXT_MAX] if isinstance(value, str) else value


def state_of(machine: Machine) -> State:
    """Return what a machine does now.

    Positions of axes and of their distance control have a `unit`, mm or °, and are None before the
    drives have started; times are simulated, ns.
    """
    channel = machine.channel
    command = at_work(channel)
    alarms = [*channel.alarms, *channel.further_alarms]
    return {
        "time_ns": machine.scheduler.now_ns,
        "channel": _word(channel.state.name),
        "is_held": channel.path.is_held,
        "block": None if command is None else command.block.place,
        "block_text": None if command is None else command.block.text,
        "waits_for": waited_for(channel),
        "axes": [_axis(machine, link) for link in channel.links],
        "probes": [_probe(machine, name) for name in machine.plant.probes],
        "distance": [_distance(machine, name, found) for name, found in _controls(channel)],
        "bus": [state for part in machine.installed for state in part.shown()],
        "real_time": _real_time(machine),
        "alarms": [str(alarm) for alarm in alarms[-LATEST:]],
        "messages": [message.shown for message in machine.messages[-LATEST:]],
    }


def _unit(machine: Machine, name: str) -> str:
    """The unit of lengths of an axis, or of the channel."""
    return "°" if name != CHANNEL and is_rotary(machine.settings, name) else "mm"


def _word(name: str) -> str:
    """The name of a state as a reader writes it."""
    return name.lower().replace("_", " ")


def _axis(machine: Machine, link: Drive) -> State:
    name, channel = link.name, machine.channel
    measuring = channel.single.measuring_state(name)
    is_known = channel.state is not ChannelState.STARTING
    return {
        "axis": name,
        "unit": _unit(machine, name),
        "is_outside": name in machine.outside,
        "set": link.set_mm if is_known else None,
        "actual": link.actual_mm if is_known else None,
        "lag": link.lag_mm if is_known else None,
        "drive": _word(link.state_name),
        "measuring": None if measuring is None else _word(measuring),
        "input": link.is_actuated,
        "touch_probe": _touch_probe(link),
        "latch": _last_latch(machine, name),
    }


def _touch_probe(link: Drive) -> str:
    """What the touch probe function of a drive reports in 60B9."""
    if link.has_latched:
        return "edge stored"
    if link.is_armed:
        return "armed"
    return "ordered" if link.is_probing else "off"


def _last_latch(machine: Machine, axis: str) -> State | None:
    """The measured position of the last run of an axis that has one."""
    for record in reversed(machine.channel.records[-_RUNS_LOOKED_AT:]):
        if axis in record.latched_mm:
            at_ns = record.end_ns if record.signal_ns is None else record.signal_ns
            return {
                "position": record.latched_mm[axis],
                "block": record.block,
                "time_ns": at_ns,
            }
    return None


def _probe(machine: Machine, name: str) -> State:
    signal = machine.plant.probes[name].signal
    return {
        "probe": name,
        "level": signal.level,
        "edges": len(signal.edges),
        "edge_ns": signal.edges[-1][0] if signal.edges else None,
    }


def _controls(channel: Channel) -> list[tuple[str, Sensing]]:
    """The distance controls by axis, that of the channel (3D) last."""
    found: list[tuple[str, Sensing]] = list(channel.distance.axes.items())
    whole = channel.distance.channel
    return found if whole is None else [*found, (CHANNEL, whole)]


def _distance(machine: Machine, name: str, found: Sensing) -> State:
    """A distance control; what no sensor has reported yet is null."""
    control, sensor_mm = found.control, found.sensor_mm
    is_known = sensor_mm is not None
    is_constant = control.state is DistanceState.ACTIVE_CONST_DIST
    return {
        "axis": name,
        "unit": _unit(machine, name),
        "state": _word(control.state.name),
        "source": control.source.name,
        "sensor": source_word(found.sensor),
        "is_held": found.is_held,
        "is_dry_run": control.is_dry_run,
        "reading": None if sensor_mm is None else sensor_mm * control.settings.sensor_sign,
        "distance": control.distance_mm if is_known else None,
        "set_name": "SET_DIST" if is_constant else "SET_POS",
        "set": control.set_dist_mm if is_constant else control.set_pos_mm,
        "filtered": control.filtered_mm,
        "error": control.error_mm,
        "offset": control.offset_mm,
    }


def _real_time(machine: Machine) -> State | None:
    """How well real time is kept; None for simulated time."""
    scheduler = machine.scheduler
    if not isinstance(scheduler, PacedScheduler):
        return None
    kept = scheduler.deadlines
    latest_ns = kept.latest_ns(SYNCS_LOOKED_AT)
    return {
        "syncs": kept.cycles,
        "looked_at": len(latest_ns),
        "late": sum(late_ns > kept.late_ns for late_ns in latest_ns),
        "late_us": kept.late_ns / US,
        "worst_us": max(latest_ns, default=0) / US,
        "slipped_ms": kept.slipped_ns / MS,
        "send_errors": kept.send_errors,
    }
