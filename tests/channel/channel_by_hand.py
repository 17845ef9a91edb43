"""A channel without a bus: its drives are where they are sent, all else is led by the test."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

from tests.channel.random_programs import IdealLink

from axisrig.kernel.channel import Channel, ChannelSettings, ChannelState, CycleTiming, Surroundings
from axisrig.kernel.channel.path.execution import BlockEnd, BlockWatch
from axisrig.kernel.drives.interface import DriveAccesses
from axisrig.kernel.drives.power import Power, PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.nc import canon
from axisrig.kernel.plc.interface import PlcParticipant
from axisrig.kernel.time.clock import MS


class Link(IdealLink):
    """A drive whose power the test sets; off_mm: how far it is from its set position."""

    def __init__(self, name: str, at_mm: float) -> None:
        super().__init__(name, at_mm)
        self.settings = SimpleNamespace(
            increments_per_mm=1000.0, fault_reset=False, probe_input=1, edge="POS"
        )
        self.power, self.is_placed, self.is_in_fault = Power.OPERATING, True, False
        self.acknowledges_faults = self.has_reported = self.runs_open = self.leads_itself = False
        self.is_sercos, self.probe_input, self.edge = name == "Z", 1, "POS"
        self.orders: list[PowerOrder] = []
        self.off_mm = 0.0

    @property
    def actual_mm(self) -> float:
        return self.set_mm + self.off_mm

    @property
    def place_mm(self) -> float:
        return self.actual_mm

    @property
    def actual_increments(self) -> int:
        return round(self.actual_mm * 1000)

    def order(self, order: PowerOrder) -> None:
        self.orders.append(order)

    def find_place(self) -> None:
        """It is known."""

    def close_loop(self) -> None:
        """It is closed."""

    def forget_fault(self) -> None:
        """There is none."""


class Watch:
    """What the channel watches: raises what it is given, once; further: as a real one."""

    def __init__(self) -> None:
        self.further: list[Alarm] = []
        self.taken: list[Alarm] = []
        self.conditions: list[Alarm] = []
        self.calls: list[str] = []

    def begin(self) -> None:
        self.calls.append("begin")

    def end(self) -> None:
        self.calls.append("end")

    def begin_cycle(self) -> None:
        self.calls.append("sync")

    def _raise(self, found: list[Alarm]) -> None:
        alarms = list(found)
        found.clear()
        if alarms:
            self.further = alarms[1:]
            raise alarms[0]

    def take(self) -> None:
        self.calls.append("take")
        self._raise(self.taken)

    def check_drives(self) -> None:
        self.calls.append("drives")
        self._raise(self.conditions)


class Mechanics:
    """Axes that sway for some time after a program; asked: how often."""

    def __init__(self, *, goes_on: bool = False) -> None:
        self.goes_on, self.sways, self.asked = goes_on, 0, 0

    def advance_to(self, _sync_ns: int) -> None:
        """Nothing to do."""

    def has_come_to_rest(self) -> bool:
        self.asked += 1
        self.sways -= 1
        return self.sways < 0


class Answers(DriveAccesses):
    """Drives that still have to answer."""

    def __init__(self) -> None:
        self.busy = self.waiting = False

    @property
    def is_busy(self) -> bool:
        return self.busy

    @property
    def is_waiting(self) -> bool:
        return self.waiting


class Ends(BlockWatch):
    """How blocks have ended."""

    def __init__(self) -> None:
        self.found: list[BlockEnd] = []

    def ends(self, how: BlockEnd) -> None:
        self.found.append(how)


class Bench:
    """X and Z at 0; steps: what each cycle has called, newest last."""

    def __init__(
        self, words: Any, *, goes_on: bool = False, settings: ChannelSettings | None = None,
        outlives: bool = False,
    ) -> None:  # fmt: skip
        self.clock: Any = SimpleNamespace(now_ns=0, call_at=lambda *_any: None)
        self.links = {name: Link(name, 0.0) for name in "XZ"}
        self.watch, self.mechanics, self.answers = Watch(), Mechanics(goes_on=goes_on), Answers()
        around: Any = Surroundings(
            lambda _message: None,
            self.watch,
            self.answers,
            self.mechanics,  # type: ignore[arg-type]
        )
        axes = [replace(words.axis(name).settings(), number=n) for n, name in enumerate("XZ", 3)]
        links: Any = list(self.links.values())
        self.channel = Channel(self.clock, CycleTiming(MS), axes, links, around, settings)
        self.turns = 0
        self.is_idle = True
        self.channel.plc.join(
            PlcParticipant(self._turn, outlives_program=outlives, is_idle=lambda: self.is_idle)
        )
        self.ends = Ends()
        self.channel.execution.watches.append(self.ends)
        self.switched_off: list[tuple[str, ...]] = []
        distance: Any = self.channel.distance
        distance.switch_off = lambda axes: self.switched_off.append(tuple(axes))

    def _turn(self) -> None:
        self.turns += 1

    def start(self, *commands: canon.Command) -> "Bench":
        """Begin with a program; the first cycle finds the drives in operation."""
        self.channel.load(iter(commands))
        self.channel.start()
        return self.cycle()

    def cycle(self, count: int = 1) -> "Bench":
        for _ in range(count):
            self.clock.now_ns += MS
            self.channel.cycle()
        return self

    def until(self, state: ChannelState, most: int = 5000) -> "Bench":
        for _ in range(most):
            if self.channel.state is state:
                return self
            self.cycle()
        raise AssertionError(f"still {self.channel.state.name}")

    @property
    def state(self) -> ChannelState:
        return self.channel.state

    @property
    def ids(self) -> tuple[list[int], list[int]]:
        """IDs of what came up, and of what came up besides."""
        channel = self.channel
        return [a.id for a in channel.alarms], [a.id for a in channel.further_alarms]
