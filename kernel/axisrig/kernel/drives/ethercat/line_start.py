"""Starts a segment and its drives: from INIT to OP, each step with its time-out and one alarm.

The order is that of public masters (docs/ethercat.md): count the slaves, bring all to INIT, give
addresses; of each slave read the EEPROM, set up the mailbox, PREOP, objects and PDOs; then clocks,
process data, SAFEOP, SYNC0, cyclic frames, OP. A slave that fails is left where it is, and the
others go on, so that each failing one has its own alarm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Final

from axisrig.kernel.drives.cia402.objects import object_name
from axisrig.kernel.drives.ethercat import clocks
from axisrig.kernel.drives.ethercat.eeprom import Described, EepromError, read_eeprom
from axisrig.kernel.drives.ethercat.frames import Datagram, at_position
from axisrig.kernel.drives.ethercat.image import LOGICAL, Place
from axisrig.kernel.drives.ethercat.mailbox_port import STATUS, MailboxPort
from axisrig.kernel.drives.ethercat.master import Master
from axisrig.kernel.drives.ethercat.settings import RegisterInputs, SlaveSettings, station_of
from axisrig.kernel.drives.ethercat.steps import (
    Ask,
    DriveSteps,
    Pause,
    Stepper,
    Steps,
    read_register,
    write_all,
    write_register,
)
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.ethercat.layouts import (
    FMMU,
    FMMU_READ,
    FMMU_WRITE,
    SM_ENABLE,
    SYNC_MANAGER,
)
from axisrig.kernel.profiles.ethercat.tables import (
    AL_ERROR,
    AlState,
    Command,
    address_of,
    al_status_text,
    state_name,
)
from axisrig.kernel.time.clock import MS, Clock, TimeNs

Ended = Callable[[Alarm | None], None]
POLL_NS: Final[TimeNs] = MS
ATTEMPTS: Final = 3  # to find the slaves
SYNC_LEAD_CYCLES: Final = 10
"""So many cycles after it is set up SYNC0 begins."""
FMMU_ALL_BITS: Final = (0, 7)
MANAGERS: Final = 4
"""SyncManagers of a slave with a drive: mailboxes, outputs, inputs."""


@dataclass
class Starting:
    """One slave on its way. drive: the steps of its family. Without one it has no mailbox."""

    settings: SlaveSettings | RegisterInputs
    mailbox: MailboxPort | None
    drive: DriveSteps | None
    ended: Ended | None = None
    described: Described | None = None
    has_failed: bool = False

    @property
    def station(self) -> int:
        """Its station address."""
        return station_of(self.settings)


class LineStart:
    """The start-up of one segment; `begin` of any slave begins it for all, in an event."""

    def __init__(self, master: Master, clock: Clock, slaves: Sequence[Starting]) -> None:
        self._master, self._clock, self._line = master, clock, master.line
        self._slaves = list(slaves)
        self._stepper = Stepper(master.transactions, clock)
        self._has_begun = False

    def begin(self, number: int, ended: Ended) -> None:
        """Start; `ended` is called once for the slave with this number."""
        self._slaves[number].ended = ended
        if not self._has_begun:
            self._has_begun = True
            self._stepper.run(self._steps())

    @property
    def _alive(self) -> list[Starting]:
        return [slave for slave in self._slaves if not slave.has_failed]

    def _fail(self, slave: Starting, alarm: Alarm) -> None:
        """End the start-up of a slave; that of one without a drive is that of the first drive."""
        owner = self._slaves[0] if slave.drive is None else slave
        is_new = not owner.has_failed
        slave.has_failed = owner.has_failed = True
        if is_new:
            assert owner.ended is not None, "all have begun at the same instant"
            owner.ended(alarm)

    def _steps(self) -> Steps:
        yield Pause(0)  # until all have begun
        wrong = yield from self._find()
        if wrong is not None:
            # One alarm for the segment; the program ends by it
            self._fail(self._slaves[0], wrong)
            self._end()
            return
        yield from self._reset()
        for phase in (self._to_preop, self._set_up):
            for slave in self._alive:
                yield from self._guarded(slave, phase(slave))
        reference = yield from self._set_clocks()
        if reference is not None and self._line.compensates_drift:
            yield from self._follow(reference)
        self._master.prepare(reference)
        for slave in self._alive:
            yield from self._map(slave)
        if reference is not None:
            yield from self._begin_sync()
        self._master.run_alone()
        for phase in (self._to_safeop, self._to_op, self._in_op):
            for slave in self._alive:
                yield from self._guarded(slave, phase(slave))
        self._end()

    def _end(self) -> None:
        drives = [slave.ended for slave in self._alive if slave.ended is not None]
        if not drives:
            self._master.stop()
        for ended in drives:
            ended(None)

    def _guarded(self, slave: Starting, steps: Steps) -> Steps:
        """Run the steps of a slave; an alarm ends them for this slave alone."""
        try:
            yield from steps
        except Alarm as alarm:
            self._fail(slave, alarm)

    # The line as a whole

    def _find(self) -> Steps:
        """Count the slaves; return the alarm of a line that is not that of the rig."""
        name, begin_ns = self._line.name, self._clock.now_ns
        for _ in range(ATTEMPTS):
            answers = yield Ask([Datagram(Command.BRD, address_of("TYPE") << 16, bytes(1))])
            if answers is not None:
                found = answers[0].counter
                if found == len(self._slaves):
                    return None
                return Alarm(900701, segment=name, found=found, expected=len(self._slaves))
        waited_ms = (self._clock.now_ns - begin_ns) // MS
        return Alarm(900700, segment=name, ms=waited_ms)

    def _reset(self) -> Steps:
        """Bring all to INIT with nothing mapped, and give each its station address."""
        yield write_all("AL_CONTROL", bytes((AlState.INIT | AL_ERROR, 0)))
        yield write_all("FMMU", bytes(256))
        yield write_all("SYNC_MANAGER", bytes(128))
        yield write_all("ACTIVATION", b"\0")
        for number, slave in enumerate(self._slaves):
            address = at_position(number, address_of("STATION_ADDRESS"))
            station = slave.station.to_bytes(2, "little")
            yield Ask([Datagram(Command.APWR, address, station)])

    # One slave

    def _to_preop(self, slave: Starting) -> Steps:
        yield from self._wait(slave, AlState.INIT)
        settings = slave.settings
        try:
            described = yield from read_eeprom(slave.station)
            if slave.mailbox is not None and len(described.managers) < MANAGERS:
                raise EepromError(f"it describes {len(described.managers)} SyncManagers")
        except EepromError as error:
            raise Alarm(
                900702, axis=settings.axis, position=settings.node_id, reason=error
            ) from error
        for sub, expected in settings.identity.items():
            found = described.identity[sub - 1]
            if found != expected:
                raise Alarm(
                    900703,
                    axis=settings.axis,
                    position=settings.node_id,
                    what=object_name(0x1018, sub),
                    found=f"0x{found:X}",
                    expected=f"0x{expected:X}",
                )
        slave.described = described
        if slave.mailbox is not None:
            yield from self._open_mailbox(slave.station, slave.mailbox, described)
        yield write_register(slave.station, "EEPROM_CONFIGURATION", b"\1")
        yield from self._change(slave, AlState.PREOP)

    def _open_mailbox(self, station: int, mailbox: MailboxPort, described: Described) -> Steps:
        mailbox.places = box = described.mailbox
        (_, out_control), (_, in_control) = described.managers[:2]
        managers = SYNC_MANAGER.pack(box.out_start, box.out_size, out_control, 0, SM_ENABLE, 0)
        managers += SYNC_MANAGER.pack(box.in_start, box.in_size, in_control, 0, SM_ENABLE, 0)
        yield write_register(station, "SYNC_MANAGER", managers)

    def _to_safeop(self, slave: Starting) -> Steps:
        if slave.drive is not None:
            yield from slave.drive.before_safeop()
        yield from self._change(slave, AlState.SAFEOP)

    def _to_op(self, slave: Starting) -> Steps:
        if slave.drive is not None:
            yield from slave.drive.before_op()
        try:
            yield from self._change(slave, AlState.OP)
        except Alarm:
            if slave.drive is not None:
                slave.drive.not_in_op()
            raise

    def _in_op(self, slave: Starting) -> Steps:
        if slave.drive is not None:
            yield from slave.drive.in_op()

    def _change(self, slave: Starting, state: AlState) -> Steps:
        yield write_register(slave.station, "AL_CONTROL", bytes((state, 0)))
        yield from self._wait(slave, state)

    def _wait(self, slave: Starting, state: AlState) -> Steps:
        """Wait for a state. Raises Alarm 900704 (time-out) and 900705 (refused)."""
        settings, limit_ns = slave.settings, self._line.state_timeout_ns
        begin_ns, shown = self._clock.now_ns, "no answer"
        while True:
            answers = yield read_register(slave.station, "AL_STATUS", 6)
            if answers and answers[0].counter == 1:
                data = answers[0].data
                present, code = data[0], int.from_bytes(data[4:6], "little")
                shown = state_name(present)
                if present == state:
                    return
                if present & AL_ERROR and state is not AlState.INIT:
                    raise Alarm(
                        900705,
                        axis=settings.axis,
                        position=settings.node_id,
                        state=state.name,
                        found=shown,
                        code=al_status_text(code),
                    )
            if self._clock.now_ns - begin_ns >= limit_ns:
                raise Alarm(
                    900704,
                    axis=settings.axis,
                    position=settings.node_id,
                    state=state.name,
                    found=shown,
                    ms=limit_ns // MS,
                )
            yield Pause(POLL_NS)

    def _set_up(self, slave: Starting) -> Steps:
        """Set up the drive; of a slave without one, its registers."""
        settings = slave.settings
        if isinstance(settings, RegisterInputs):
            for register, data in settings.writes:
                yield write_register(slave.station, register, data)
        elif slave.drive is not None:
            yield from slave.drive.in_preop()

    def _map(self, slave: Starting) -> Steps:
        """Set up SyncManagers and FMMUs of the process data, and of the state of the mailbox."""
        assert slave.described is not None
        number, settings = self._slaves.index(slave), slave.settings
        image = self._master.image
        if isinstance(settings, RegisterInputs):
            at = image.registers[number - len(image.places)]
            part = at, settings.size, settings.first, FMMU_READ
            yield write_register(slave.station, "FMMU", fmmu_of(*part))
            return
        place = image.places[number]
        (out_start, out_control), (in_start, in_control) = slave.described.managers[2:4]
        managers = SYNC_MANAGER.pack(
            out_start, place.output_bytes, out_control, 0, SM_ENABLE, 0
        ) + SYNC_MANAGER.pack(in_start, place.input_bytes, in_control, 0, SM_ENABLE, 0)
        yield write_register(slave.station, "SYNC_MANAGER", managers, 2 * SYNC_MANAGER.size)
        yield write_register(slave.station, "FMMU", fmmus_of(place, out_start, in_start))

    # Clocks

    def _set_clocks(self) -> Steps:
        """Set up the clocks; return the station of the reference, None where there is none."""
        if not self._line.has_clocks:
            return None
        for slave in self._alive:
            if not (yield from clocks.has_clock(slave.station)):
                self._fail(slave, Alarm(900706, **_place(slave)))
        stations = [slave.station for slave in self._alive]
        if not stations:
            return None
        writes_delay = self._line.compensates_delay
        silent = yield from clocks.set_clocks(stations, self._clock, writes_delay=writes_delay)
        for slave in self._alive:
            if slave.station in silent:
                self._fail(slave, Alarm(900706, **_place(slave)))
        return None if silent else stations[0]

    def _begin_sync(self) -> Steps:
        """Let SYNC0 of all slaves begin at the same system time, on the grid of the cycles."""
        period_ns = self._line.period_ns
        lead_ns = SYNC_LEAD_CYCLES * period_ns
        start_ns = -(-(self._clock.now_ns + lead_ns) // period_ns) * period_ns
        for slave in (each for each in self._alive if each.drive is not None):
            yield from clocks.begin_sync(slave.station, start_ns + self._line.shift_ns, period_ns)

    def _follow(self, reference: int) -> Steps:
        """Hand the time on until each clock follows it."""
        line, begin_ns = self._line, self._clock.now_ns
        while True:
            parts = clocks.distribution(reference, self._clock.now_ns)
            parts += [clocks.difference(slave.station) for slave in self._alive]
            answers = yield Ask(parts)
            found = clocks.differences_ns(answers[2:]) if answers else [None] * len(self._alive)
            if all(off_ns is not None and off_ns <= line.clock_limit_ns for off_ns in found):
                return
            if self._clock.now_ns - begin_ns >= line.clock_timeout_ns:
                waited_ms = line.clock_timeout_ns // MS
                for slave, off_ns in zip(self._alive, found, strict=True):
                    if off_ns is None or off_ns > line.clock_limit_ns:
                        shown = "unknown" if off_ns is None else f"{off_ns}"
                        self._fail(slave, Alarm(900707, **_place(slave), ns=shown, ms=waited_ms))
                return
            yield Pause(line.period_ns)


def _place(slave: Starting) -> dict[str, Any]:
    return {"axis": slave.settings.axis, "position": slave.settings.node_id}


def fmmus_of(place: Place, out_start: int, in_start: int) -> bytes:
    """Return three FMMUs: outputs, inputs, and the state of the mailbox (SyncManager 1)."""
    parts = (
        (place.outputs, place.output_bytes, out_start, FMMU_WRITE),
        (place.inputs, place.input_bytes, in_start, FMMU_READ),
        (place.mailbox, 1, STATUS, FMMU_READ),
    )
    return b"".join(fmmu_of(*part) for part in parts)


def fmmu_of(at: int, size: int, start: int, kind: int) -> bytes:
    """Return an FMMU of whole bytes; at: in the process image, start: in the slave."""
    return FMMU.pack(LOGICAL + at, size, *FMMU_ALL_BITS, start, 0, kind, 1)


class SlaveStart:
    """The start-up of one drive, a part of that of its line (`DriveStart`)."""

    def __init__(self, line: LineStart, number: int) -> None:
        self.begin: Callable[[Ended], None] = partial(line.begin, number)
