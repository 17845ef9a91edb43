"""A servo without a bus in a mode of operation, given its object values cycle by cycle."""

from typing import Any

from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.drive.cia402.servo import Servo
from axisrig.kernel.time.clock import MS
from axisrig.kernel.time.scheduler import new_scheduler

PER_M = 104_857_600
REACHED, LIMITED, FOLLOWS = 1 << 10, 1 << 11, 1 << 12


class ServoAlone:
    """Walks to operation in `mode` with SYNCs at 1, 2 and 3 ms. axis: of `conftest.py`.

    sent: its emergencies as code, register and first own byte; changes: how often a tick has
    changed the statusword.
    """

    def __init__(self, axis: Any, mode: int = 8, **given: Any) -> None:
        self.axis, self.clock = axis, new_scheduler()
        self.sent: list[tuple[int, int, int]] = []
        self.changes = 0
        profile = given.pop("profile", DriveProfile())
        signals = given.pop("signals", (None, None))
        self.servo = Servo(
            axis, signals, profile, lambda *error: self.sent.append(error), self.clock,
            self._changed, switches=given.pop("switches", None),
        )  # fmt: skip
        self.image = self.servo.image
        self.write(mode=mode, **given)
        for word in (0x06, 0x07, 0x0F):
            self.cycle(controlword=word)

    def _changed(self) -> None:
        self.changes += 1

    @property
    def now_ns(self) -> int:
        return self.clock.now_ns

    def write(self, **values: float) -> None:
        """Write objects as SDO does: the time until now belongs to the old ones."""
        self.servo.begin(self.now_ns)
        self._put(values)
        self.servo.update()
        self.servo.react(self.now_ns)

    def cycle(self, **values: float) -> int:
        """Do the next SYNC with what RPDOs carry; return the statusword of its sample."""
        self.clock.run_until((self.now_ns // MS + 1) * MS)
        self.servo.begin(self.now_ns)
        self._put(values)
        self.servo.cycle(self.now_ns)
        return self.image.statusword

    def run_ms(self, time_ms: float) -> None:
        """Let time pass, in which the drive has its ticks alone."""
        self.clock.run_until(self.now_ns + round(time_ms * MS))
        self.axis.advance_to(self.now_ns)

    def _put(self, values: dict[str, float]) -> None:
        for name, value in values.items():
            setattr(self.image, name, round(value))
