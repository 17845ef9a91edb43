"""Homing by a drive of CiA 402: mode 6, then back to the mode of before.

The method and its speeds are those of the drive (6098, 6099, 609A, 607C; docs/homing.md). Source:
CiA 402-2.
"""

from collections.abc import Callable
from enum import Enum, auto
from typing import Final, Protocol

from axisrig.kernel.drives.cia402.objects import ObjectAccess, SdoError, object_name
from axisrig.kernel.drives.cia402.settings import HOMING_LIMIT_NS
from axisrig.kernel.drives.interface import DriveHoming
from axisrig.kernel.errors import Alarm
from axisrig.kernel.profiles.cia402.ds402 import Status
from axisrig.kernel.time.clock import Clock, S, TimeNs

HOMING_MODE: Final = 6
MODE, MODE_DISPLAY, METHOD, ERROR_CODE = 0x6060, 0x6061, 0x6098, 0x603F
START: Final = 1 << 4  # of the controlword
# The bits of an earlier homing stay until the drive has seen the start; none takes longer
BLIND_CYCLES: Final = 16
MODE_POLLS_MAX: Final = 100  # readings of 6061 until the mode has changed
# A bus with little room gets an SDO frame only now and then, so that no telegram is late twice
SDO_CYCLES: Final = 4


class Phase(Enum):
    """The progress of the homing of an axis."""

    ENTERING = auto()  # the drive changes to mode 6
    SEARCHING = auto()
    PROVING = auto()  # the drive is asked where the axis stands by the new reference
    EXPLAINING = auto()  # it has failed, and the drive is asked why
    LEAVING = auto()  # back to the mode of before
    DONE = auto()


class HomingLink(Protocol):
    """What a homing needs of the link to its drive."""

    name: str
    mode_bits: int
    leads_itself: bool
    may_jump: bool

    @property
    def node_id(self) -> int: ...  # noqa: D102
    @property
    def statusword(self) -> int: ...  # noqa: D102

    @property
    def is_placed(self) -> bool: ...  # noqa: D102
    def forget_place(self) -> None: ...  # noqa: D102
    def find_place(self) -> None: ...  # noqa: D102
    def set_object(self, index: int, sub: int, value: int) -> None: ...  # noqa: D102


class AxisHoming(DriveHoming):
    """The homing of one axis over SDO and the bits of the mode in the controlword.

    limit_ns: one that takes longer has failed.
    """

    def __init__(
        self,
        link: HomingLink,
        clock: Clock,
        sdo: ObjectAccess,
        limit_ns: TimeNs = HOMING_LIMIT_NS,
    ) -> None:
        self._link, self._clock, self._sdo, self._limit_ns = link, clock, sdo, limit_ns
        self.phase = Phase.ENTERING
        self._mode_before: int | None = None  # until the drive has reported it
        self._attempt = 0  # answers to questions of an earlier one do not count
        self._polls = self._cycles = self._pause = 0
        self._request: Callable[[], None] | None = None
        self._begin_ns = clock.now_ns
        self._answers: dict[int, int] = {}
        self._failed: Alarm | None = None
        link.leads_itself = link.may_jump = True
        self._read(MODE_DISPLAY, self._enter)

    @property
    def is_done(self) -> bool:
        """Whether the axis is homed, or the homing broken off."""
        return self.phase is Phase.DONE

    def step(self) -> None:
        """Look how far the drive is; raises Alarm 900190, 900011, 900084 and 900085."""
        if self._failed is not None:
            raise self._failed
        self._pause += 1
        if self._request is not None and self._pause >= SDO_CYCLES:
            request, self._request, self._pause = self._request, None, 0
            request()
        if self.phase is Phase.SEARCHING:
            self._look()
        elif self.phase is Phase.PROVING:
            self._prove()

    def abort(self) -> None:
        """Break off: the drive stops the axis, and further steps lead it back to its mode."""
        if self.phase is Phase.DONE:
            return
        self._link.mode_bits = 0
        self.phase, self._failed, self._request = Phase.LEAVING, None, None
        self._attempt += 1
        if self._mode_before is None:
            self._leave()
        else:
            self._begin_proof()

    def _look(self) -> None:
        self._cycles += 1
        if self._cycles <= BLIND_CYCLES:
            return
        word = self._link.statusword
        if word & Status.HOMING_ERROR:
            self._explain("the drive reports an error of homing")
        elif word & Status.HOMING_ATTAINED and word & Status.TARGET_REACHED:
            self._link.mode_bits = 0
            self._begin_proof()
        elif self._clock.now_ns - self._begin_ns > self._limit_ns:
            waits = (
                " (bit 12 of 6041 is set, bit 10 is not)" if word & Status.HOMING_ATTAINED else ""
            )
            self._explain(f"not at its end after {self._limit_ns / S:g} s{waits}")

    def _begin_proof(self) -> None:
        """Ask where the axis stands, before the drive follows set positions again."""
        self.phase = Phase.PROVING
        self._link.forget_place()

    def _prove(self) -> None:
        self._link.may_jump = False
        self._link.find_place()
        if self._link.is_placed:
            assert self._mode_before is not None, "it has been asked for first"
            self.phase = Phase.LEAVING
            self._change_mode(self._mode_before, self._leave)

    # Changing the mode over SDO

    def _enter(self, mode: int) -> None:
        self._mode_before = mode
        self._change_mode(HOMING_MODE, self._begin)

    def _begin(self) -> None:
        self._link.mode_bits = START
        self.phase, self._cycles = Phase.SEARCHING, 0

    def _leave(self) -> None:
        self._link.leads_itself = self._link.may_jump = False
        self.phase = Phase.DONE

    def _change_mode(self, mode: int, then: Callable[[], None]) -> None:
        self._polls, attempt = 0, self._attempt

        def poll(shown: int) -> None:
            self._polls += 1
            if shown == mode:
                then()
            elif self._polls > MODE_POLLS_MAX:
                self._refused(f"mode {mode}", f"6061 shows mode {shown}")
            else:
                self._read(MODE_DISPLAY, poll)

        def written(answer: bytes | SdoError) -> None:
            if attempt != self._attempt:
                return
            if isinstance(answer, SdoError):
                self._refused(f"mode {mode} ({object_name(MODE, 0)})", str(answer))
            else:
                self._read(MODE_DISPLAY, poll)

        try:
            self._link.set_object(MODE, 0, mode)
        except KeyError:  # no RPDO carries it
            data = mode.to_bytes(1, "little", signed=True)
            self._request = lambda: self._sdo.write(MODE, 0, data, written)
        else:
            self._read(MODE_DISPLAY, poll)

    def _read(self, index: int, then: Callable[[int], None]) -> None:
        attempt = self._attempt

        def done(answer: bytes | SdoError) -> None:
            if attempt != self._attempt:
                return
            if isinstance(answer, SdoError):
                self._refused(f"the question for {object_name(index, 0)}", str(answer))
            else:
                then(int.from_bytes(answer, "little", signed=index != ERROR_CODE))

        self._request = lambda: self._sdo.read(index, 0, done)

    # Failures

    def _refused(self, step: str, answer: str) -> None:
        link = self._link
        self._failed = Alarm(900011, axis=link.name, node=link.node_id, step=step, answer=answer)

    def _explain(self, reason: str) -> None:
        """Ask the drive for method and error code, then fail."""
        self.phase = Phase.EXPLAINING
        word = self._link.statusword

        def report(error: int) -> None:
            self._failed = Alarm(
                900190,
                axis=self._link.name,
                method=self._answers[METHOD],
                reason=reason,
                statusword=f"0x{word:04X}",
                error=f"0x{error:04X}",
            )

        def keep(method: int) -> None:
            self._answers[METHOD] = method
            self._read(ERROR_CODE, report)

        self._read(METHOD, keep)
