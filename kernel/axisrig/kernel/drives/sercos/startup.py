"""Starts a SERCOS drive on its way from PREOP (phase 2) to OP (phase 4).

In PREOP the start-up list of the rig, cycle times and telegrams are written, and what positions
and real-time bits are in the drive is held against the lists of the control; S-0-0127 and S-0-0128
are the checks before phases 3 and 4; in OP the probing cycle begins (S-0-0170). Which steps a real
control does is not documented (docs/ambiguities.md).
"""

from fractions import Fraction
from functools import partial
from typing import Final

from axisrig.kernel.drives.ethercat.steps import Call, DriveSteps, Pause, Steps
from axisrig.kernel.drives.sercos.link import SercosDrive
from axisrig.kernel.drives.sercos.service_channel import SoeError
from axisrig.kernel.drives.sercos.settings import SercosSettings
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.sercos import words
from axisrig.kernel.profiles.sercos.service import (
    RUN,
    Attribute,
    Element,
    Kind,
    command_states,
    ident_name,
    ident_number,
    pack_list,
    read_list,
)
from axisrig.kernel.time.clock import MS, TimeNs

POLL_NS: Final[TimeNs] = 2 * MS
POLLS_MAX: Final = 500
CYCLES: Final = (ident_number("S-0-0001"), ident_number("S-0-0002"))
MODE, POSITION_MODE = ident_number("S-0-0032"), 11
SCALING, FACTOR, EXPONENT, RESOLUTION = (ident_number(f"S-0-00{n}") for n in (76, 77, 78, 79))
CHECK_3, CHECK_4 = ident_number("S-0-0127"), ident_number("S-0-0128")
INVALID_3, INVALID_4 = ident_number("S-0-0021"), ident_number("S-0-0022")
KIND_MASK: Final = 0x07
LINEAR, ROTARY = 1, 2
BY_PARAMETER: Final = 0x08
PREFERRED_PER_MM: Final = Fraction(10_000)
PREFERRED_PER_TURN: Final = Fraction(3_600_000)
STATES: Final = command_states()
ENDED: Final = (STATES["DONE"], STATES["FAILED"], STATES["INTERRUPTED"])


class SercosSteps(DriveSteps):
    """One drive."""

    def __init__(self, settings: SercosSettings, drive: SercosDrive) -> None:
        self._settings, self._drive = settings, drive
        self._channel, self._number = drive.channel, drive.drive_number

    # Idents

    def _get(self, ident: int, elements: Element = Element.VALUE) -> Steps:
        return (yield Call(partial(self._channel.read, self._number, ident, elements)))

    def _read(self, ident: int) -> Steps:
        """Return the number of an ident. Raises Alarm 900743."""
        found = yield from self._get(ident)
        if isinstance(found, SoeError):
            raise self._refused(f"the reading of {ident_name(ident)}", found)
        return int.from_bytes(found, "little", signed=ident == EXPONENT)

    def _write(self, ident: int, number: int) -> Steps:
        """Write the number of an ident, as long as its attribute says. Raises Alarm 900743."""
        step = f"{ident_name(ident)} = {_shown(ident, number)}"
        found = yield from self._get(ident, Element.ATTRIBUTE)
        if isinstance(found, SoeError):
            raise self._refused(step, found)
        attribute = Attribute.read(found)
        try:
            data = number.to_bytes(attribute.width, "little", signed=attribute.kind is Kind.SIGNED)
        except OverflowError as error:
            raise Alarm(
                900743,
                axis=self._settings.axis,
                step=step,
                answer=f"it does not fit into {attribute.width} bytes",
            ) from error
        yield from self._put(ident, data, step)

    def _put(self, ident: int, data: bytes, step: str) -> Steps:
        found = yield Call(partial(self._channel.write, self._number, ident, data))
        if isinstance(found, SoeError):
            raise self._refused(step, found)

    def _refused(self, step: str, answer: SoeError) -> Alarm:
        return Alarm(900743, axis=self._settings.axis, step=step, answer=str(answer))

    # PREOP

    def in_preop(self) -> Steps:
        """Write what is to be written in phase 2, then compare."""
        settings = self._settings
        for ident, number in settings.writes:
            yield from self._write(ident, number)
        for ident in CYCLES:
            yield from self._write(ident, settings.period_us)
        yield from self._write(MODE, POSITION_MODE)
        yield from self._write(words.TELEGRAM_TYPE, words.LISTED)
        for ident, pdos in ((words.AT_LIST, settings.inputs), (words.MDT_LIST, settings.outputs)):
            listed = [each.index for pdo in pdos for each in pdo.objects][1:]
            names = " ".join(ident_name(each) for each in listed)
            data = pack_list(listed, 2, len(listed))
            yield from self._put(ident, data, f"{ident_name(ident)} = {names}")
        yield from self._check_scaling()
        if settings.measures:
            yield from self._check_probe()

    def _check_scaling(self) -> Steps:
        """Hold the position unit of the drive against that of the control. Raises Alarm 900745."""
        kind = yield from self._read(SCALING)
        found: Fraction | None = None
        if kind & KIND_MASK == LINEAR:
            found = PREFERRED_PER_MM
            if kind & BY_PARAMETER:
                factor = yield from self._read(FACTOR)
                exponent = yield from self._read(EXPONENT)
                found = 1 / (1000 * factor * Fraction(10) ** exponent)
        elif kind & KIND_MASK == ROTARY:
            per_turn = PREFERRED_PER_TURN
            if kind & BY_PARAMETER:
                per_turn = Fraction((yield from self._read(RESOLUTION)))
            found = per_turn / Fraction(str(self._settings.lead_mm))
        expected = self._settings.increments_per_mm
        if found is None or float(found) != expected:
            shown = "no position unit" if found is None else f"{float(found):.12g}"
            raise Alarm(
                900745,
                axis=self._settings.axis,
                kind=f"0x{kind:02X}",
                found=shown,
                expected=f"{expected:.12g}",
            )

    def _check_probe(self) -> Steps:
        """Hold real-time bits and S-0-0169 against the lists. Raises Alarm 900744."""
        bits, drive = self._settings.bits, self._drive
        idents = words.PROBES[drive.probe_input, drive.edge]
        wanted = [
            (words.CONTROL_BITS, bits.enable, idents.enable),
            (words.STATUS_BITS, bits.latched, idents.latched),
        ]
        if bits.command:
            wanted.append((words.CONTROL_BITS, bits.command, words.PROBE_COMMAND))
        for allocations, mask, expected in wanted:
            allocation = allocations[words.REAL_TIME.index(mask)]
            found = yield from self._read(allocation)
            if found != expected:
                raise self._other(allocation, _name(found), _name(expected))
        level = words.STATUS_BITS[words.REAL_TIME.index(bits.actuated)]
        found = yield from self._read(level)
        drive.knows_level = found == idents.level
        select = yield from self._read(words.PROBE_CONTROL)
        if not select & idents.select:
            raise self._other(words.PROBE_CONTROL, f"0x{select:X}", f"bit 0x{idents.select:X} set")

    def _other(self, ident: int, found: str, expected: str) -> Alarm:
        drive = self._drive
        return Alarm(
            900744,
            axis=drive.name,
            ident=ident_name(ident),
            found=found,
            expected=expected,
            input=drive.probe_input,
            edge=drive.edge,
        )

    # Phases 3 and 4

    def before_safeop(self) -> Steps:
        """Let the drive check phase 3; each invalid ident is a warning 140038."""
        yield from self._check(CHECK_3, INVALID_3, 140038)

    def before_op(self) -> Steps:
        """Let the drive check phase 4; each invalid ident is a warning 140040."""
        yield from self._check(CHECK_4, INVALID_4, 140040)

    def not_in_op(self) -> None:
        """Warn with 140041."""
        self._drive.warn(Alarm(140041, axis=self._drive.name, phase=4))

    def _check(self, command: int, invalid: int, warning: int) -> Steps:
        state = yield from self._run(command)
        if state == STATES["DONE"]:
            return
        found = yield from self._get(invalid)
        listed = [] if isinstance(found, SoeError) else read_list(found, 2)
        for ident in listed or [command]:
            alarm = Alarm(
                warning,
                axis=self._drive.name,
                command=ident_name(command),
                ident=ident_name(ident),
                state=f"0x{state:X}",
            )
            self._drive.warn(alarm)

    def _run(self, command: int) -> Steps:
        """Let a procedure command run to its end, then cancel it; return its last data state."""
        step = f"{ident_name(command)} = {RUN}"
        yield from self._put(command, RUN.to_bytes(2, "little"), step)
        state = STATES["RUNNING"]
        for _ in range(POLLS_MAX):
            found = yield from self._get(command, Element.DATA_STATE)
            if isinstance(found, SoeError):
                raise self._refused(step, found)
            state = int.from_bytes(found, "little")
            if state in ENDED:
                break
            yield Pause(POLL_NS)
        yield from self._put(command, bytes(2), f"{ident_name(command)} = 0")
        return state

    def in_op(self) -> Steps:
        """Begin the probing cycle, where the control has to. Raises Alarm 900743 and 900746."""
        settings = self._settings
        if not (settings.measures and settings.starts_probing) or settings.bits.command:
            return
        found = yield from self._get(words.PROBE_COMMAND, Element.DATA_STATE)
        if not isinstance(found, SoeError) and found == STATES["RUNNING"].to_bytes(2, "little"):
            return  # the drive has begun by itself (S-0-0169 bit 8)
        yield from self._write(words.PROBE_COMMAND, RUN)
        found = yield from self._get(words.PROBE_COMMAND, Element.DATA_STATE)
        if isinstance(found, SoeError) or int.from_bytes(found, "little") == STATES["FAILED"]:
            raise Alarm(900746, axis=settings.axis)


def _name(ident: int) -> str:
    return ident_name(ident) if ident else "nothing"


def _shown(ident: int, number: int) -> str:
    is_allocation = ident in (*words.CONTROL_BITS, *words.STATUS_BITS)
    return _name(number) if is_allocation else str(number)
