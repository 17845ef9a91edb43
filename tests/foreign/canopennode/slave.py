"""A drive around CANopenNode: its stack speaks CANopen, some thirty lines here are the drive.

Nothing of our own drive node is used: states, words and objects are written once more. The axis is
ideal: at each SYNC it stands at the target of the SYNC before. A surface lies at `surface`
increments; the probe is deflected at or below it and its edge is where the axis meets it.
"""

import ctypes
import subprocess
from collections.abc import Iterable
from pathlib import Path

import can

from axisrig.bench.bus.can.simbus import SimBus
from axisrig.kernel.time.clock import MS, US, Phase
from axisrig.kernel.time.scheduler import Scheduler

from .dictionary import RECORDS, write_dictionary

HERE = Path(__file__).parent
SOURCES = ("CANopen.c", *(f"301/{name}.c" for name in (
    "CO_Emergency", "CO_HBconsumer", "CO_NMT_Heartbeat", "CO_ODinterface", "CO_PDO",
    "CO_SDOserver", "CO_SYNC", "CO_fifo", "crc16-ccitt",
)))  # fmt: skip
SEND = ctypes.CFUNCTYPE(None, ctypes.c_uint16, ctypes.c_uint8, ctypes.POINTER(ctypes.c_uint8))
# CiA 402-2, statusword: state bits; 0x0200 remote, 0x1000 drive follows its target
WORDS = {"disabled": 0x0240, "ready": 0x0231, "on": 0x0233, "enabled": 0x1237, "fault": 0x0208}
DRIVE_ERROR_BIT, DRIVE_ERROR = 0x30, 0x7300


def build(checkout: Path, folder: Path, compiler: str) -> Path:
    """Compile the stack of a checkout with our driver into a shared library."""
    write_dictionary(folder)
    library = folder / "canopennode.so"
    command = [compiler, "-std=c11", "-O1", "-fPIC", "-shared", "-o", str(library)]
    command += [f"-I{place}" for place in (HERE, folder, checkout)]
    command += [str(HERE / "node.c"), str(folder / "OD.c")]
    subprocess.run([*command, *(str(checkout / name) for name in SOURCES)], check=True)
    return library


class ForeignDrive:
    """One drive at a port of a segment; a process can hold one, as the stack keeps it in globals.

    surface: in increments, None = nothing to touch. The log holds what happened: (time_ns, text).
    """

    def __init__(
        self,
        library: Path,
        port: SimBus,
        scheduler: Scheduler,
        node_id: int,
        start: int = 0,
        surface: int | None = None,
    ) -> None:
        self._c = ctypes.CDLL(str(library))
        self._c.node_take.restype = ctypes.c_bool
        self._port, self._scheduler, self.node_id = port, scheduler, node_id
        self._send = SEND(self._on_send)  # must live as long as the stack
        self.position = self.target = start
        self.surface = surface
        self.state = "disabled"
        self.latched: list[int] = []
        self._control = 0
        self._processed_ns = self._taken_ns = scheduler.now_ns
        self._is_open = True
        error = self._c.node_open(node_id, self._send)
        if error:
            raise RuntimeError(f"CANopenNode did not start: {error & 0xFFFFFFFF:#x}")
        self._write_actual()
        port.attach(self._on_frame)
        scheduler.call_at(scheduler.now_ns, Phase.APPLICATION, self._tick)

    def close(self) -> None:
        """Give the stack back; nothing is called afterwards."""
        self._is_open = False
        self._c.node_close()

    def fail(self) -> None:
        """Go into fault, with an emergency message."""
        self.state = "fault"
        self._c.node_error(True, DRIVE_ERROR_BIT, DRIVE_ERROR, 0)

    # Values of the dictionary

    def _variable(self, index: int) -> ctypes._SimpleCData:
        ((_, ctype, _, _),) = RECORDS[index]
        return getattr(ctypes, f"c_{ctype.removesuffix('_t')}").in_dll(self._c, f"v{index:X}_0")

    def get(self, index: int) -> int:
        """Return the value of a plain object."""
        return int(self._variable(index).value)

    def set(self, index: int, value: int) -> None:
        """Set the value of a plain object."""
        self._variable(index).value = value

    # The bus

    def _on_send(self, ident: int, length: int, data: Iterable[int]) -> None:
        self._port.send_raw(ident, bytes(data[:length]))

    def _on_frame(self, message: can.Message) -> None:
        if not self._is_open or message.is_error_frame or message.is_extended_id:
            return
        data = (ctypes.c_uint8 * 8)(*message.data)
        self._c.node_receive(message.arbitration_id, message.dlc, data, message.is_remote_frame)
        self._scheduler.call_at(self._scheduler.now_ns, Phase.APPLICATION, self._process)

    def _tick(self) -> None:
        if self._is_open:
            self._process()
            self._scheduler.call_at(self._scheduler.now_ns + MS, Phase.APPLICATION, self._tick)

    def _process(self) -> None:
        if not self._is_open:
            return
        error = self._c.node_process(self._passed_us())
        assert not error, f"CANopenNode did not start again: {error & 0xFFFFFFFF:#x}"
        passed_us = (self._scheduler.now_ns - self._taken_ns) // US
        self._taken_ns += passed_us * US
        is_sync = self._c.node_take(passed_us)
        if is_sync:
            self._cycle()
        self._c.node_give(is_sync, passed_us)

    def _passed_us(self) -> int:
        passed_us = (self._scheduler.now_ns - self._processed_ns) // US
        self._processed_ns += passed_us * US
        return passed_us

    # The drive

    def _cycle(self) -> None:
        before, self.position = self.position, self.target
        self._probe(before)
        self._obey(self.get(0x6040))
        if self.state == "enabled":
            self.target = self.get(0x607A)
        self.set(0x6061, self.get(0x6060))
        self._write_actual()

    def _write_actual(self) -> None:
        self.set(0x6041, WORDS[self.state])
        self.set(0x6064, self.position)
        level = self.surface is not None and self.position <= self.surface
        self.set(0x60FD, level << 16)

    def _obey(self, word: int) -> None:
        """The commands of CiA 402-2 that a master needs on its way up and down."""
        reset = bool(word & 0x80) and not self._control & 0x80
        self._control = word
        if self.state == "fault":
            if reset:
                self.state = "disabled"
                self._c.node_error(False, DRIVE_ERROR_BIT, 0, 0)
            return
        if not word & 0x02 or not word & 0x04:
            self.state = "disabled"
        elif not word & 0x01:
            self.state = "ready"
        elif self.state in ("ready", "on", "enabled"):
            self.state = "enabled" if word & 0x08 and self.state != "ready" else "on"

    def _probe(self, before: int) -> None:
        function, status = self.get(0x60B8), self.get(0x60B9)
        if not function & 1:
            self.set(0x60B9, 0)
            return
        status |= 1
        surface = self.surface
        if surface is not None and before > surface >= self.position and function & 0x10:
            if not status & 2:
                self.latched.append(surface)
                self.set(0x60BA, surface)
                self.set(0x60D5, self.get(0x60D5) + 1 & 0xFFFF)
            status |= 2
        self.set(0x60B9, status)
