"""Everything that single axes do beside or instead of the common path, as the channel sees it."""

from collections.abc import Callable, Mapping

from axisrig.kernel.channel.axes.coupling import Couplings
from axisrig.kernel.channel.axes.homing import Homing
from axisrig.kernel.channel.axes.independent import IndependentAxes
from axisrig.kernel.channel.path.execution import Execution
from axisrig.kernel.channel.path.measurement import Measurement
from axisrig.kernel.channel.path.path import Path
from axisrig.kernel.channel.path.settings import CycleTiming
from axisrig.kernel.channel.path.settling import Rest
from axisrig.kernel.drives.interface import Drive, DriveHoming
from axisrig.kernel.nc import canon
from axisrig.kernel.time.clock import Clock, TimeNs


class SingleAxes:
    """Carries out the commands of single axes; links: by axis.

    override_permille: gives the override of an axis, see `IndependentAxes`.
    is_active: whether anything is to be done in this cycle. homed: every axis that has been homed,
    with the cycle in which it was known.
    """

    def __init__(
        self,
        clock: Clock,
        timing: CycleTiming,
        path: Path,
        measurement: Measurement,
        links: Mapping[str, Drive],
        couplings: Couplings,
        override_permille: Callable[[str], int],
    ) -> None:
        self._clock, self._path, self._links = clock, path, links
        self._timing, self._measurement = timing, measurement
        self.independent = IndependentAxes(
            clock, timing, path, measurement, links, override_permille
        )
        self.couplings = couplings
        self._homing: Homing | None = None
        self._leaving: dict[str, DriveHoming] = {}  # broken off: the drive is still in its mode
        self._leaving_rest: Rest | None = None
        self.homed: list[tuple[TimeNs, str]] = []
        self._awaited: tuple[str, ...] = ()
        self._adopted: tuple[str, ...] = ()
        self._rest: Rest | None = None
        self.is_active = False

    def assign(self, execution: Execution) -> None:
        """Say what is carried out here."""
        execution.while_busy(self._is_busy)
        execution.register(canon.IndependentMove, self._move)
        execution.register(canon.WaitIndependent, self._wait)
        execution.register(canon.AxisLinkOn, self._couple, ready=self._are_in_position)
        execution.register(canon.AxisLinkOff, self._part, ready=self._stand)
        execution.register(canon.Homing, self._home, ready=self._are_in_position)
        execution.register(canon.AxisExchange, self._exchange, ready=self._stand)
        execution.register(canon.AdoptActual, self._adopt, ready=self._stand)

    def _renew(self) -> None:
        """Most programs have no single axes, and what is not there must cost nothing."""
        self.is_active = (
            self.independent.is_moving
            or self.couplings.watched
            or self._homing is not None
            or self._rest is not None
        )

    @property
    def is_moving(self) -> bool:
        """Whether an independent axis is under way."""
        return self.independent.is_moving

    def measuring_state(self, axis: str) -> str | None:
        """Return how far the run of an axis is, on the path or beside it; None without one."""
        return self._measurement.state_of(axis) or self.independent.measuring_state(axis)

    def _is_busy(self) -> bool:
        if self._homing is not None or self._rest is not None:
            return True
        if self._awaited and not self.independent.are_moving(self._awaited):
            self._awaited = ()
        return bool(self._awaited)

    def _move(self, command: canon.IndependentMove) -> None:
        self.independent.begin(command)
        self._renew()

    def _couple(self, command: canon.AxisLinkOn) -> None:
        self.couplings.switch_on(command)
        self._renew()

    def _part(self, command: canon.AxisLinkOff) -> None:
        self.couplings.switch_off(command)
        self._renew()

    def _wait(self, command: canon.WaitIndependent) -> None:
        self._awaited = command.axes

    def _stand(self) -> bool:
        return self._path.has_stopped and not self.independent.is_moving

    def _are_in_position(self) -> bool:
        return not self.independent.is_moving and self._path.is_in_position()

    def _exchange(self, command: canon.AxisExchange) -> None:
        """Nothing moves: the drive of an axis that is away holds it."""
        for axis in command.given:
            self._measurement.forget_prepared(axis)
            self._path.programmed.forget_times(axis)

    def _home(self, command: canon.Homing) -> None:
        for group in command.groups:
            for axis in group:
                self._measurement.forget_prepared(axis)
        self._homing = Homing(command.groups, self._path, self._links, self._clock)
        self._renew()

    def _adopt(self, command: canon.AdoptActual) -> None:
        """The lag of an axis that comes to rest is no position to stay at: wait for its end."""
        axes = [(self._path.settings(axis), self._links[axis]) for axis in command.axes]
        self._adopted = command.axes
        self._rest = Rest(self._clock, self._timing.period_ns, axes)
        self._renew()

    def _adopt_at_rest(self, rest: Rest) -> None:
        if rest.judge():
            for axis in self._adopted:
                self._path.put(axis, self._links[axis].place_mm)
            self._rest = None

    # Each cycle

    def step(self) -> None:
        """Evaluate what came with this cycle."""
        self.independent.step()
        if self.couplings.watched:
            self.couplings.watch()
        if self._rest is not None:
            self._adopt_at_rest(self._rest)
        if self._homing is not None:
            done = self._homing.step()
            self.homed += [(self._clock.now_ns, axis) for axis in self._homing.homed]
            if done:
                self._homing = None
                self._path.settle_anew()

    def advance(self) -> None:
        """Lead the axes on by one cycle."""
        self.independent.advance()
        self._renew()

    def stop(self) -> None:
        """Stop after an alarm or a reset: every axis on its own, homing broken off."""
        self.independent.stop()
        self._awaited = ()
        self._rest = None
        if self._homing is not None:
            self._leaving |= self._homing.abort()
            self._homing = self._leaving_rest = None
        self._renew()

    def end_program(self) -> None:
        """End the couplings: they are those of the program."""
        self.couplings.end_program()
        self._renew()

    def lead_back(self) -> bool:
        """Lead drives out of a homing that was broken off; return whether all follow set positions.

        Called once per cycle while the set positions rest; the mode changes when the axes rest too.
        Raises Alarm 900011 and 900200.
        """
        if not self._leaving:
            return True
        for axis in self._leaving:
            self._path.put(axis, self._links[axis].place_mm)
        if self._leaving_rest is None:
            axes = [(self._path.settings(axis), self._links[axis]) for axis in self._leaving]
            self._leaving_rest = Rest(self._clock, self._timing.period_ns, axes)
        if not self._leaving_rest.judge():
            return False
        for homing in self._leaving.values():
            homing.step()
        self._leaving = {a: h for a, h in self._leaving.items() if not h.is_done}
        return not self._leaving
