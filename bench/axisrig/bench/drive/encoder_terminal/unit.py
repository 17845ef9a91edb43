"""An incremental encoder terminal: counter and latch of 16 bits, control and status byte."""

from axisrig.bench.drive.speed_drive.latch import EnabledLatch
from axisrig.kernel.profiles.encoder_terminal import words


class EncoderTerminal:
    """One terminal; it counts from 0 when it gets power, and an edge of CNT_SET sets it."""

    def __init__(self) -> None:
        self.latch = EnabledLatch()
        self._ahead = 0  # of the counter before the encoder
        self._had_set, self._is_set = True, False

    def reset(self, position: int) -> None:
        """Be as after power on: a CNT_SET that is there already is no edge."""
        self.latch.reset()
        self._ahead = -position
        self._had_set, self._is_set = True, False

    @property
    def has_own_power(self) -> bool:
        """It has that of the drive."""
        return False

    def edges(self) -> tuple[bool, ...]:
        """Return a rising edge while the latch is armed; a falling one it does not latch."""
        return (True,) if self.latch.is_armed else ()

    def pulse(self, edge: bool, position: int) -> None:
        """Take a rising edge of the latch input."""
        self.latch.pulse(position + self._ahead)

    def command(self, values: dict[str, int], position: int) -> None:
        """Take the control byte and the value for the counter."""
        control = values.get("CONTROL", 0)
        wants_set = bool(control & words.CNT_SET)
        if wants_set and not self._had_set:
            self._ahead, self._is_set = values["SET"] - position, True
        self._had_set, self._is_set = wants_set, self._is_set and wants_set
        self.latch.enable(is_enabled=bool(control & words.EN_LAT_EXT))

    def inputs(self, position: int, *, level: bool) -> dict[str, int]:
        """Return status byte, counter and latch. level: of the latch input."""
        status = words.LAT_EXT_VAL if self.latch.is_valid else 0
        status |= words.CNTSET_ACC if self._is_set else 0
        status |= words.LEVEL if level else 0
        return {
            "STATUS": status,
            "COUNTER": (position + self._ahead) % words.COUNTS,
            "LATCH": self.latch.value % words.COUNTS,
        }
