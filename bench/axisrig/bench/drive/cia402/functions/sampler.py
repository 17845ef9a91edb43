"""Actual values of a drive: what the objects say of axis and inputs."""

from collections import deque
from typing import Final

from axisrig.bench.drive.axis.motion import POSITION, Motion
from axisrig.bench.drive.axis.switches import Switches
from axisrig.bench.drive.cia402.dictionary.image import ProcessImage
from axisrig.bench.drive.cia402.functions.limits import Limits
from axisrig.bench.drive.cia402.functions.touch_probe import TouchProbe
from axisrig.bench.drive.cia402.functions.units import Units
from axisrig.kernel.profiles.cia402.ds402 import PROBE_INPUT_BITS

SELDOM: Final = frozenset(
    {
        "position_demand",
        "position_internal",
        "position_demand_internal",
        "torque_actual",
        "current_actual",
        "second_position",
    }
)
"""Values that few telegrams carry: sampled at a SYNC only when one does, else when read by SDO."""
_INPUT_SHIFT: Final = PROBE_INPUT_BITS[1]


class Sampler:
    """Writes the actual values into the process image.

    is_watched: a telegram carries SELDOM. second_delay: the second encoder is shown as it was so
    many SYNCs ago, where a telegram carries it; that many samples, where they are taken apart from
    the SYNC.
    """

    def __init__(
        self,
        image: ProcessImage,
        units: Units,
        motion: Motion,
        limits: Limits,
        touch_probe: TouchProbe,
        switches: Switches,
        second_delay: int = 0,
    ) -> None:
        self._image, self._units, self._motion = image, units, motion
        self._limits, self._touch_probe, self._switches = limits, touch_probe, switches
        self._second: deque[int] = deque(maxlen=second_delay + 1)
        self.is_watched = True
        self._is_apart = False  # until the first such sample

    def sample(self) -> None:
        """Sample what usual telegrams carry."""
        image, units, motion = self._image, self._units, self._motion
        axis, probe = motion.axis, self._touch_probe
        motor_m = axis.motor_position_m()
        image.position_actual = units.position_units(motor_m)
        image.velocity_actual = units.velocity_units_s(axis.motor_velocity_m_s())
        lag_m = axis.demand_position_m() - motor_m if motion.kind is POSITION else 0.0
        image.following_error = units.deviation_units(lag_m)
        image.probe_status = probe.status
        image.digital_inputs = probe.inputs << _INPUT_SHIFT | self._switches.word

    def sample_seldom(self, at_sync: bool = False, *, is_apart: bool = False) -> None:
        """Sample the rest; at_sync: for a telegram that belongs to this SYNC.

        is_apart: for what is sent, at an instant of its own.
        """
        self._is_apart |= is_apart
        image, units, motion = self._image, self._units, self._motion
        demand_m = motion.position_m()
        image.position_demand = units.position_units(demand_m)
        image.position_demand_internal = units.increments(demand_m)
        image.position_internal = units.increments(motion.axis.motor_position_m())
        image.torque_actual = image.current_actual = self._limits.torque_per_mille()
        second_m = motion.axis.second_encoder_m()
        second = 0 if second_m is None else units.second_units(second_m)
        past = self._second
        if is_apart or (at_sync and not self._is_apart):
            past.append(second)
        is_delayed = past.maxlen != 1 and len(past) > 0
        image.second_position = past[0] if is_delayed else second
