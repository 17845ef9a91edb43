"""Reports what a master outside does to the drives of a rig, one line for each thing that happens.

It looks at the nodes, on CAN at every frame too; it changes nothing. Lines go to `put_out`, and
to `events.csv` and `latches.csv` where a folder is given.
"""

import csv
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

from axisrig.bench.bus.can.dissect import NMT_COMMANDS
from axisrig.bench.bus.can.frame import Frame
from axisrig.bench.drive.canopen.node import DriveNode
from axisrig.bench.drive.ethercat.node import EthercatDrive
from axisrig.bench.drive.sercos.node import SercosDrive
from axisrig.bench.machine.ethercat.line_meter import al_words
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.cosim.plant.plant import Plant
from axisrig.kernel.cosim.plant.probe import Contact
from axisrig.kernel.profiles.canopen.aborts import abort_text
from axisrig.kernel.profiles.canopen.emergency import Emergency
from axisrig.kernel.profiles.canopen.identifiers import EMERGENCY_BASE, SDO_ANSWER_BASE, SYNC_ID
from axisrig.kernel.time.clock import S, TimeNs

SDO_ABORT = 0x80
SYNC_LOST_NS = S // 2
EVENT_COLUMNS = ("time_ns", "axis", "kind", "text")
LATCH_COLUMNS = (
    *("time_ns", "axis", "probe", "object", "units", "latched_mm"),
    *("contact_ns", "contact_mm"),
)
# Probe, level after the edge, and what position and counter are called in the process image
_LATCHES = (
    (1, True, "latch_1_positive", "count_1_positive"),
    (1, False, "latch_1_negative", "count_1_negative"),
    (2, True, "latch_2_positive", "count_2_positive"),
    (2, False, "latch_2_negative", "count_2_negative"),
)


class DriveWords(NamedTuple):
    """What a family calls its mode, its control word and its four latches."""

    mode: str
    control: str
    latches: tuple[str, ...]


CIA402 = DriveWords("6060", "6040", ("0x60BA", "0x60BB", "0x60BC", "0x60BD"))
SERCOS = DriveWords("S-0-0032", "S-0-0134", ("S-0-0130", "S-0-0131", "S-0-0132", "S-0-0133"))


@dataclass
class _Seen:
    """What was seen of a node last."""

    communication: str
    state: str
    mode: int
    counts: tuple[int, ...]


N = TypeVar("N", DriveNode, EthercatDrive)


class NodeWatcher(Generic[N]):
    """Watches the drives of a rig.

    put_out: takes each line. folder: where events.csv and latches.csv go, or None.
    """

    LABEL: ClassVar[str]

    def __init__(
        self,
        settings: Settings,
        nodes: Mapping[str, N],
        plant: Plant,
        put_out: Callable[[str], None],
        folder: Path | None,
        opened: ExitStack,
    ) -> None:
        self._settings, self._plant, self._put_out = settings, plant, put_out
        self._nodes: Mapping[str, N] = nodes
        self._seen = {name: self._look_at(node) for name, node in nodes.items()}
        self._events: Any = _table(folder, "events.csv", EVENT_COLUMNS, opened)
        self._latches: Any = _table(folder, "latches.csv", LATCH_COLUMNS, opened)

    def report(self, time_ns: TimeNs, axis: str, kind: str, text: str) -> None:
        """Put one line out."""
        self._put_out(f"{time_ns / S:12.6f} s  {axis:<4} {kind:<7} {text}")
        if self._events:
            self._events([time_ns, axis, kind, text])

    def look(self, time_ns: TimeNs) -> None:
        """Report what has changed in the nodes since the last look."""
        for name, node in self._nodes.items():
            seen, now = self._seen[name], self._look_at(node)
            if now == seen:
                continue
            self._seen[name] = now
            if now.communication != seen.communication:
                text = f"{seen.communication} -> {now.communication}"
                self.report(time_ns, name, self.LABEL, text)
            words = self._words(node)
            if now.mode != seen.mode:
                self.report(time_ns, name, "mode", f"{seen.mode} -> {now.mode} ({words.mode})")
            if now.state != seen.state:
                word = f"({words.control} = 0x{self._control(node):04X})"
                self.report(time_ns, name, "state", f"{seen.state} -> {now.state} {word}")
            if now.counts != seen.counts:
                self._tell_latches(name, node, seen, now)

    def _communication(self, node: N) -> str:
        """Return the state of what a drive has of its carrier."""
        raise NotImplementedError

    def _words(self, node: N) -> DriveWords:
        """Return the words of its family."""
        return CIA402

    def _control(self, node: N) -> int:
        """Return the control word that the master has sent."""
        return node.image.controlword

    def _per_mm(self, node: N) -> float:
        """Return the units of a latched position per millimetre."""
        return float(node.profile.units_per_mm)

    def _look_at(self, node: N) -> _Seen:
        return _Seen(
            self._communication(node),
            node.state.name,
            node.image.mode,
            tuple([getattr(node.image, count) for *_, count in _LATCHES]),
        )

    def _tell_latches(self, name: str, node: N, seen: _Seen, now: _Seen) -> None:
        per_mm = self._per_mm(node)
        names = self._words(node).latches
        for latch, title, old, count in zip(_LATCHES, names, seen.counts, now.counts, strict=True):
            if count in (0, old):
                continue
            probe, level, field, _ = latch
            units = getattr(node.image, field)
            # Of the edge itself: both may have come since the last look
            latch_ns = node.servo.touch_probe.probes[probe - 1].latches[level].instant_ns
            text = f"probe {probe}, {title} = {units} = {units / per_mm:.6f} mm"
            row = [latch_ns, name, probe, title, units, units / per_mm, "", ""]
            contact = self._contact(name, probe, latch_ns)
            plant = self._settings.rig.axis[name].plant
            if contact is not None and plant in contact.position_mm:
                truth_mm = contact.position_mm[plant]
                row[-2:] = [contact.time_ns, truth_mm]
                text += f"; contact was at {truth_mm:.6f} mm"
            self.report(latch_ns, name, "latch", text)
            if self._latches:
                self._latches(row)

    def _contact(self, name: str, probe: int, latch_ns: TimeNs) -> Contact | None:
        """Return the last contact before a latch, of the probe at this input."""
        axis = self._settings.rig.axis[name]
        instance = axis.probe_1 if probe == 1 else axis.probe_2
        contacts = self._plant.probes[instance].contacts if instance else []
        return max(
            (c for c in contacts if c.time_ns <= latch_ns), key=lambda c: c.time_ns, default=None
        )


class Watcher(NodeWatcher[DriveNode]):
    """Watches the nodes of a rig and the frames of its segments."""

    LABEL = "NMT"

    def __init__(
        self,
        settings: Settings,
        nodes: Mapping[str, DriveNode],
        plant: Plant,
        put_out: Callable[[str], None],
        folder: Path | None,
        opened: ExitStack,
    ) -> None:
        super().__init__(settings, nodes, plant, put_out, folder, opened)
        self._names = {
            (settings.rig.axis[name].segment, node.node_id): name for name, node in nodes.items()
        }
        self._syncs: dict[str, TimeNs] = {}

    def _communication(self, node: DriveNode) -> str:
        return node.nmt_state.name

    def __call__(self, time_ns: TimeNs, segment: str, frame: Frame, is_error: bool) -> None:
        """Look at one frame; the nodes have not acted on it yet."""
        self.look(time_ns)
        can_id, data = frame.arbitration_id, frame.data
        if is_error:
            self.report(time_ns, "", "bus", f"error frame on {segment}")
        elif frame.is_extended_id or frame.is_remote_frame:
            return
        elif can_id == SYNC_ID:
            if segment not in self._syncs:
                self.report(time_ns, "", "SYNC", f"begins on {segment}")
            self._syncs[segment] = time_ns
        elif can_id == 0 and len(data) == 2:
            what = NMT_COMMANDS.get(data[0], f"unknown command {data[0]}")
            who = f"node {data[1]}" if data[1] else "all nodes"
            self.report(time_ns, self._names.get((segment, data[1]), ""), "NMT", f"{what}, {who}")
        else:
            self._answer(time_ns, segment, can_id, data)

    def _answer(self, time_ns: TimeNs, segment: str, can_id: int, data: bytes) -> None:
        name = self._names.get((segment, can_id & 0x7F))
        if name is None:
            return
        if can_id & 0x780 == EMERGENCY_BASE and len(data) == 8:
            emergency = Emergency.read(data)
            register = f"error register 0x{emergency.register:02X}"
            self.report(
                time_ns, name, "EMCY", str(emergency) if emergency.code else f"reset, {register}"
            )
        elif can_id & 0x780 == SDO_ANSWER_BASE and len(data) == 8 and data[0] == SDO_ABORT:
            what = f"0x{data[2]:02X}{data[1]:02X}:{data[3]:02X}"
            code = int.from_bytes(data[4:], "little")
            text = abort_text(code).removeprefix("abort ")
            self.report(time_ns, name, "SDO", f"abort of {what} with {text}")

    def look(self, time_ns: TimeNs) -> None:
        """Report what has changed in the nodes since the last look, and a SYNC that stays away."""
        super().look(time_ns)
        for segment, sync_ns in list(self._syncs.items()):
            if time_ns - sync_ns > SYNC_LOST_NS:
                del self._syncs[segment]
                self.report(time_ns, "", "SYNC", f"none on {segment} since {sync_ns / S:.6f} s")


class EthercatWatcher(NodeWatcher[EthercatDrive]):
    """Watches the drives of a line of EtherCAT, of CiA 402 and of SERCOS."""

    LABEL = "AL"

    def _communication(self, node: EthercatDrive) -> str:
        return al_words(node.states.state, node.states.code)

    def _words(self, node: EthercatDrive) -> DriveWords:
        return SERCOS if isinstance(node, SercosDrive) else CIA402

    def _control(self, node: EthercatDrive) -> int:
        return node.front.control if isinstance(node, SercosDrive) else super()._control(node)

    def _per_mm(self, node: EthercatDrive) -> float:
        """Of a SERCOS drive by its scaling, which a master may write (S-0-0076 to S-0-0079)."""
        if not isinstance(node, SercosDrive):
            return super()._per_mm(node)
        per_turn = Fraction(node.image.feed, node.image.feed_shaft)
        return float(per_turn * 1000 / node.profile.lead_um)


def _table(folder: Path | None, name: str, columns: tuple[str, ...], opened: ExitStack) -> Any:
    """Open a table, write its header, return what writes a row; each is on disk at once."""
    if folder is None:
        return None
    file = opened.enter_context(
        (folder / name).open("w", encoding="utf-8", newline="", buffering=1)
    )
    write = csv.writer(file, lineterminator="\n").writerow
    write(columns)
    return write
