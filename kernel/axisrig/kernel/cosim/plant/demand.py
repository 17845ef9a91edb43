"""What an axis FMU is given: the demand, the kind of control, the force limits."""

import struct
from typing import Any, Final

from axisrig.kernel.cosim.fmi.fmu import FmuSlave
from axisrig.kernel.cosim.fmi.roles import Roles, Values
from axisrig.kernel.profiles.control_kind import ControlKind
from axisrig.kernel.time.clock import TimeNs

AXIS_INPUTS = ("reference_position", "reference_velocity", "reference_time", "reference_end")
SAMPLE_NS: Final = 62_500


class Ramp:
    """Hands the demand over as a ramp that the FMU follows by itself."""

    def __init__(self, roles: Roles) -> None:
        self._inputs = roles.exchange(AXIS_INPUTS)
        self._pack: Any = struct.Struct("=4d").pack_into  # four assignments in one call

    def command(self, time_ns: TimeNs, position: float, rate: float, end_ns: TimeNs) -> None:
        """Demand a ramp in SI units from `time_ns` on; it rests from `end_ns` on."""
        self._pack(self._inputs.values, 0, position, rate, time_ns * 1e-9, end_ns * 1e-9)
        self._inputs.write()

    def step(self, slave: FmuSlave, end_ns: TimeNs) -> None:
        """Step the FMU to `end_ns`."""
        slave.step_to(end_ns)


class Control:
    """Further inputs of a drive: kind of control, slope of the velocity, force, force limits.

    Written only when they change, so that an axis in position control pays nothing for them.
    """

    def __init__(self, roles: Roles) -> None:
        def known(group: str, *names: str) -> Values | None:
            return roles.exchange(names) if roles.has_group(group) else None

        has_control = roles.has_group("control") and roles.has_group("ramp")
        self._kind = known("control", "control") if has_control else None
        self._slope = known("control", "reference_acceleration")
        self._force = known("control", "reference_force")
        self._limits = known("force_limits", "force_limit_negative", "force_limit_positive")
        self._limit = known("force_limit", "force_limit") if self._limits is None else None
        self.kind = ControlKind.POSITION
        self.kinds = frozenset(ControlKind if has_control else {ControlKind.POSITION})

    def choose(self, kind: ControlKind) -> None:
        """Choose what is controlled."""
        if kind is not self.kind:
            assert self._kind is not None
            self._kind.values[0] = kind.value
            self._kind.write()
            self.kind = kind

    def give_slope(self, acceleration: float) -> None:
        """Give the slope of a demanded velocity, m/s2."""
        assert self._slope is not None
        self._slope.values[0] = acceleration
        self._slope.write()

    def give_force(self, force: float) -> None:
        """Give the demanded force, N."""
        assert self._force is not None
        self._force.values[0] = force
        self._force.write()

    @property
    def limits_force(self) -> bool:
        """Whether `limit` acts on this FMU."""
        return self._limits is not None or self._limit is not None

    def limit(self, negative: float, positive: float) -> None:
        """Limit the force of each direction; amounts, N."""
        if self._limits is not None:
            self._limits.values[0], self._limits.values[1] = negative, positive
            self._limits.write()
        elif self._limit is not None:  # one limit for both directions: the tighter one
            self._limit.values[0] = min(negative, positive)
            self._limit.write()


class SampledDemand:
    """Samples the ramp for an FMU that takes a plain demand and holds it.

    The samples are SAMPLE_NS apart from the command on, whatever the steps are.
    """

    def __init__(self, roles: Roles) -> None:
        self._input = roles.exchange(["demand"])
        self._begin_ns = self._end_ns = 0
        self._position = self._rate = 0.0

    def at(self, time_ns: TimeNs) -> float:
        """Return the demand at an instant, m."""
        return self._position + self._rate * (min(time_ns, self._end_ns) - self._begin_ns) * 1e-9

    def command(self, time_ns: TimeNs, position: float, rate: float, end_ns: TimeNs) -> None:
        """Demand a ramp in SI units from `time_ns` on; it rests from `end_ns` on."""
        self._begin_ns, self._position, self._rate, self._end_ns = time_ns, position, rate, end_ns

    def step(self, slave: FmuSlave, end_ns: TimeNs) -> None:
        """Step the FMU to `end_ns`, with the samples of the ramp on the way."""
        if slave.grid_ns is not None:  # it takes a demand at the begin of its step
            self._input.values[0] = self.at(slave.time_ns)
            self._input.write()
            slave.step_to(end_ns)
        while slave.time_ns < end_ns:
            since_ns = slave.time_ns - self._begin_ns
            sample_ns = self._begin_ns + since_ns // SAMPLE_NS * SAMPLE_NS
            self._input.values[0] = self.at(sample_ns)
            self._input.write()
            slave.step_to(min(sample_ns + SAMPLE_NS, end_ns))
