"""Starts one node by its list of steps; many of these run at the same time.

Nothing waits: each step asks something of the drive and goes on in the answer's event. Sources:
CiA 302-2 (boot-up), CiA 301 (NMT, SDO, PDO parameters), CiA 402-2 (scaling).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

from axisrig.kernel.drives.canopen.sdo import Network
from axisrig.kernel.drives.canopen.startup_steps import (
    SCALING,
    BootUp,
    Check,
    CheckScaling,
    Keep,
    Nmt,
    Scaling,
    StartUpSettings,
    Step,
    Write,
)
from axisrig.kernel.drives.cia402.objects import Done, ObjectAccess, SdoError, object_name
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.canopen.identifiers import ERROR_CONTROL_BASE, NMT_ID
from axisrig.kernel.profiles.canopen.nmt import BOOT_UP
from axisrig.kernel.time.clock import MS, Clock, Phase

Ended = Callable[[Alarm | None], None]
"""Called once when a node is operational (None) or could not be started (the alarm)."""


@dataclass(frozen=True)
class DriveAddress:
    """Which node it is: its axis, or what it is else, and its id, for messages."""

    axis: str
    node_id: int


class StartUp:
    """The start-up of one node. `step` shows where it is.

    network: None where no NMT is among the steps. keep(index, sub, value): takes the values of
    objects that RPDOs will carry for drive functions.

    Raises nothing; `ended` gets Alarm 900011 (an object was not taken), 900020 (no boot-up),
    900021 (another device) or 900022 (another scaling).
    """

    def __init__(
        self,
        drive: DriveAddress,
        network: Network | None,
        clock: Clock,
        sdo: ObjectAccess,
        steps: Sequence[Step],
        settings: StartUpSettings,
        keep: Callable[[int, int, int], None] | None = None,
    ) -> None:
        self.drive, self._network, self._clock, self._sdo = drive, network, clock, sdo
        self._steps, self._settings = list(steps), settings
        self._node = bytes((drive.node_id,))
        self._next = self._attempts = 0
        self._run_number = 0  # counts the starts: an answer to an older one does nothing
        self._waits_for_boot = False
        self._keep = keep
        self._read: dict[tuple[int, int], int] = {}
        self._ended: Ended | None = None
        if network is not None:
            network.subscribe(ERROR_CONTROL_BASE + drive.node_id, self._on_heartbeat)

    def begin(self, ended: Ended) -> None:
        """Start with the first step, anew where one is under way; `ended`: called at its end."""
        self._ended = ended
        self._next = self._attempts = 0
        self._run_number += 1
        self._waits_for_boot = False
        self._read.clear()
        self._run()

    @property
    def step(self) -> Step:
        """The step that is under way, the last one at the end."""
        return self._steps[min(self._next, len(self._steps) - 1)]

    def _run(self) -> None:
        """Do the next step; it calls `_advance` when it is done."""
        if self._next == len(self._steps):
            self._end(None)
            return
        match self.step:
            case BootUp(_, command):
                self._boot(command)
            case Nmt(_, command):
                self._command(command)
                self._advance()
            case Write(_, index, sub, data):
                self._sdo.write(index, sub, data, self._taker())
            case Check(_, index, sub) | Keep(_, index, sub):
                self._sdo.read(index, sub, self._taker())
            case CheckScaling():
                self._sdo.read(*SCALING[0], self._taker())

    def _advance(self) -> None:
        self._next += 1
        self._run()

    def _end(self, alarm: Alarm | None) -> None:
        ended, self._ended = self._ended, None
        if ended is not None:
            ended(alarm)

    def _command(self, command: int) -> None:
        assert self._network is not None, "its steps need NMT"
        self._network.send_message(NMT_ID, bytes((command, self.drive.node_id)))

    # Boot-up

    def _boot(self, command: int | None) -> None:
        self._attempts += 1
        self._waits_for_boot = True
        if command is not None:
            self._command(command)
        due_ns = self._clock.now_ns + self._settings.boot_timeout_ns
        timed_out = partial(self._on_boot_timeout, self._run_number)
        self._clock.call_at(due_ns, Phase.APPLICATION, timed_out)

    def _on_boot_timeout(self, run: int) -> None:
        if not self._waits_for_boot or run != self._run_number:
            return
        if self._attempts < self._settings.boot_attempts:
            self._run()
            return
        self._waits_for_boot = False
        waited_ms = self._attempts * self._settings.boot_timeout_ns // MS
        self._end(
            Alarm(
                900020,
                axis=self.drive.axis,
                node=self.drive.node_id,
                ms=waited_ms,
                attempts=self._attempts,
            )
        )

    def _on_heartbeat(self, _can_id: int, data: bytearray, _timestamp: float) -> None:
        is_boot_up = len(data) == 1 and data[0] == BOOT_UP
        if self._waits_for_boot and is_boot_up and not self._is_command_waiting:
            self._waits_for_boot = False
            self._advance()

    @property
    def _is_command_waiting(self) -> bool:
        """Whether the NMT command has not got onto the bus: a boot-up is none of its own then.

        False where this cannot be read: interfaces of python-can do not show their transmit queue.
        """
        bus = getattr(self._network, "bus", None)
        return any(
            request[4].arbitration_id == NMT_ID and request[4].data[1:] == self._node
            for request in getattr(bus, "pending", ())
        )

    # Objects

    def _taker(self) -> Done:
        return partial(self._on_answer, self._run_number)

    def _on_answer(self, run: int, result: bytes | SdoError) -> None:
        if run != self._run_number:
            return
        step = self.step
        if isinstance(result, SdoError):
            self._end(
                Alarm(
                    900011,
                    axis=self.drive.axis,
                    node=self.drive.node_id,
                    step=_asked(step, result),
                    answer=str(result),
                )
            )
        elif isinstance(step, Check):
            self._compare(step, int.from_bytes(result, "little"))
        elif isinstance(step, Keep):
            if self._keep is not None:
                value = int.from_bytes(result, "little", signed=step.signed)
                self._keep(step.index, step.sub, value)
            self._advance()
        elif isinstance(step, CheckScaling):
            self._read[SCALING[len(self._read)]] = int.from_bytes(result, "little")
            if len(self._read) < len(SCALING):
                self._sdo.read(*SCALING[len(self._read)], self._taker())
            else:
                self._compare_scaling(step.expected)
        else:
            self._advance()

    def _compare(self, step: Check, value: int) -> None:
        if value & step.mask == step.expected:
            self._advance()
        else:
            self._end(
                Alarm(
                    900021,
                    axis=self.drive.axis,
                    node=self.drive.node_id,
                    step=step.name,
                    found=f"0x{value:X}",
                    expected=f"0x{step.expected:X}",
                )
            )

    def _compare_scaling(self, expected: Scaling) -> None:
        """Compare increments and position units per motor revolution.

        Source: CiA 402-2, position = increments * feed / (encoder resolution * gear ratio).
        """
        encoder, motor, gear, shaft, feed, per_shaft = (self._read[place] for place in SCALING)
        if not all((motor, gear, shaft, per_shaft)):
            found = "a factor of 0 in 608F, 6091 or 6092"
            self._end(
                Alarm(
                    900022,
                    axis=self.drive.axis,
                    node=self.drive.node_id,
                    found=found,
                    expected=_shown(expected),
                )
            )
            return
        reported = Scaling(encoder, Fraction(feed, per_shaft) * Fraction(shaft, gear))
        exact = Fraction(encoder, motor)
        if exact == expected.encoder_increments and (
            reported.units_per_revolution == expected.units_per_revolution
        ):
            self._advance()
        else:
            found = _as_text(exact, reported.units_per_revolution)
            self._end(
                Alarm(
                    900022,
                    axis=self.drive.axis,
                    node=self.drive.node_id,
                    found=found,
                    expected=_shown(expected),
                )
            )


def _asked(step: Step, failed: SdoError) -> str:
    """Say what was asked of the drive: the object in any case, the value that was written."""
    if isinstance(step, Write):
        return step.name
    name = object_name(failed.index, failed.sub)
    return f"the reading of {step.name if name in step.name else f'{name} ({step.name})'}"


def _shown(scaling: Scaling) -> str:
    return _as_text(Fraction(scaling.encoder_increments), scaling.units_per_revolution)


def _as_text(increments: Fraction, units: Fraction) -> str:
    return f"{increments} increments and {units} position units per motor revolution"
