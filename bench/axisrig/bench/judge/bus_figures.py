"""What the buses of a run carried: load, errors, waiting times; for result files and metrics."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass

from axisrig.bench.bus.load import EXTENDED_FLAG
from axisrig.bench.bus.segment import Segment
from axisrig.bench.machine.machine import Machine
from axisrig.bench.rig.check import EMCY, HEARTBEAT, SDO_ANSWER, SDO_REQUEST, overloads
from axisrig.kernel.time.clock import MS, US, S

NMT, SYNC_ID = 0x000, 0x080


@dataclass(frozen=True)
class Waiting:
    """The longest time that frames of one identifier waited for the bus.

    name: such as `Z.TPDO1`. axis: whose, or empty. can_id: bit 31 marks 29 bits.
    worst_us: from the request to the start of the attempt that got through; frames still waiting at
    the end of the run count with their time.
    """

    name: str
    axis: str
    can_id: int
    worst_us: float


@dataclass(frozen=True)
class BusFigures:
    """One segment in one run; busy counts from SOF to the end of the intermission.

    load_pct: over the whole run. load_100ms_pct, load_1ms_pct: in the worst window. counters: per
    port (name, TEC, REC, state) where something was wrong. overload: what does not fit in the worst
    case, empty when all does. waiting: the longest first.
    """

    segment: str
    bitrate: int
    load_pct: float
    load_100ms_pct: float
    load_1ms_pct: float
    frames: int
    error_frames: int
    overload: str
    counters: tuple[tuple[str, int, int, str], ...]
    waiting: tuple[Waiting, ...]

    def as_data(self) -> dict[str, object]:
        """Return it as JSON can hold it."""
        return asdict(self)


def bus_figures(machine: Machine) -> list[BusFigures]:
    """Return the figures of every segment of a run, in the order of the rig."""
    over = overloads(machine.settings)
    return [
        _figures(machine, segment, over.get(name, "")) for name, segment in machine.segments.items()
    ]


def _figures(machine: Machine, segment: Segment, overload: str) -> BusFigures:
    load = segment.load()
    bits_per_ms = segment.bitrate * MS / S
    names = frame_names(machine, segment.name)
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
    )


def _plain_name(key: int) -> str:
    return f"{key & ~EXTENDED_FLAG:#010x}" if key & EXTENDED_FLAG else f"{key:#05x}"


def frame_names(machine: Machine, segment: str) -> Mapping[int, tuple[str, str]]:
    """Return identifier -> (name, axis) for what the rig puts on one segment."""
    cycle = machine.settings.rig.cycle
    names = {
        NMT: ("NMT", ""),
        SYNC_ID: ("SYNC", ""),
        HEARTBEAT + cycle.master_node: ("heartbeat of the kernel", ""),
    }
    for name, axis in machine.settings.rig.axis.items():
        if axis.segment != segment:
            continue
        services = {
            "EMCY": EMCY, "SDO answer": SDO_ANSWER, "SDO request": SDO_REQUEST,
            "heartbeat": HEARTBEAT,
        }  # fmt: skip
        for service, base in services.items():
            names[base + axis.node] = (f"{name}.{service}", name)
        for telegram in machine.links[name].telegrams.values():
            names[telegram.cob_id(axis.node)] = (f"{name}.{telegram.name}", name)
    return names
