"""What the buses of a run carried: load, errors, waiting times; for result files and metrics."""

from collections.abc import Mapping

from axisrig.bench.bus.can.confinement import ErrorState
from axisrig.bench.bus.can.load import EXTENDED_FLAG
from axisrig.bench.bus.can.segment import Segment
from axisrig.bench.record.bus import BusChange, BusFigures, Waiting
from axisrig.bench.rig.canopen.schedule import overloads
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.drives.canopen.link import AxisLink
from axisrig.kernel.profiles.canopen.identifiers import (
    EMERGENCY_BASE,
    ERROR_CONTROL_BASE,
    NMT_ID,
    SDO_ANSWER_BASE,
    SDO_REQUEST_BASE,
    SYNC_ID,
)
from axisrig.kernel.time.clock import MS, US, S


def bus_figures(
    settings: Settings, links: Mapping[str, AxisLink], segments: Mapping[str, Segment]
) -> list[BusFigures]:
    """Return the figures of every segment of a run, in the order of the rig."""
    over = overloads(settings)
    return [
        _figures(segment, frame_names(settings, links, name), over.get(name, ""))
        for name, segment in segments.items()
    ]


def _figures(segment: Segment, names: Mapping[int, tuple[str, str]], overload: str) -> BusFigures:
    load = segment.load()
    bits_per_ms = segment.bitrate * MS / S
    waiting = [
        Waiting(*names.get(key, (_plain_name(key), "")), key, delay_ns / US)
        for key, delay_ns in load.worst_delay_ns.items()
    ]
    states = {name for _, name, _ in segment.state_changes}
    return BusFigures(
        segment=segment.name,
        bitrate=segment.bitrate,
        load_pct=100 * load.busy_share,
        load_100ms_pct=100 * load.worst_100ms_share,
        load_1ms_pct=100 * load.worst_1ms_bits / bits_per_ms,
        frames=load.frames,
        error_frames=load.error_frames,
        overload=overload,
        counters=tuple(
            (port.port_name, port.tec, port.rec, port.error_state.value)
            for port in segment.ports
            if port.tec or port.rec or port.port_name in states
        ),
        waiting=tuple(sorted(waiting, key=lambda item: (-item.worst_us, item.can_id))),
        changes=tuple(
            BusChange(time_ns, port, str(state), state is ErrorState.ACTIVE)
            for time_ns, port, state in segment.state_changes
        ),
    )


def _plain_name(key: int) -> str:
    return f"{key & ~EXTENDED_FLAG:#010x}" if key & EXTENDED_FLAG else f"{key:#05x}"


def frame_names(
    settings: Settings, links: Mapping[str, AxisLink], segment: str
) -> Mapping[int, tuple[str, str]]:
    """Return identifier -> (name, axis) for what the rig puts on one segment."""
    cycle = settings.rig.cycle
    names = {
        NMT_ID: ("NMT", ""),
        SYNC_ID: ("SYNC", ""),
        ERROR_CONTROL_BASE + cycle.master_node: ("heartbeat of the kernel", ""),
    }
    for name, axis in settings.rig.axis.items():
        if axis.segment != segment:
            continue
        services = {
            "EMCY": EMERGENCY_BASE, "SDO answer": SDO_ANSWER_BASE, "SDO request": SDO_REQUEST_BASE,
            "heartbeat": ERROR_CONTROL_BASE,
        }  # fmt: skip
        for service, base in services.items():
            names[base + axis.node_id] = (f"{name}.{service}", name)
        for telegram in links[name].telegrams.values():
            names[telegram.cob_id(axis.node_id)] = (f"{name}.{telegram.name}", name)
    return names
