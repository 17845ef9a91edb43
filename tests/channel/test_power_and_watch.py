"""What leads drives to operation and what watches their telegrams, by themselves."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel import CycleTiming
from axisrig.kernel.channel.path import monitor
from axisrig.kernel.channel.path.monitor import Monitor, PowerUp
from axisrig.kernel.drives.power import Power, PowerOrder
from axisrig.kernel.errors import Alarm
from axisrig.kernel.time.clock import MS

pytestmark = pytest.mark.interpreted
TIMING = CycleTiming(2 * MS)


class Drive:
    """A drive as its link shows it, and what it was asked for."""

    def __init__(self, name: str, **state: Any) -> None:
        self.name, self.state_name = name, "ready"
        self.power, self.is_placed = Power.OPERATING, True
        self.is_in_fault = self.has_reported = self.is_asked = False
        self.acknowledges_faults = False
        self.settings = SimpleNamespace(fault_reset=False)
        self.calls: list[str] = []
        self.__dict__.update(state)

    def find_place(self) -> None:
        self.calls.append("place")

    def order(self, order: PowerOrder) -> None:
        self.calls.append(order.name)

    def ask_for_fault(self) -> None:
        self.calls.append("ask")

    def forget_fault(self) -> None:
        self.calls.append("forget")

    def fault(self) -> Alarm:
        return Alarm(900005, axis=self.name, statusword="0x0008", emcy="none")


def power_up(*drives: Drive, **more: bool) -> PowerUp:
    links: Any = drives
    return PowerUp(links, TIMING, **more)


def test_all_drives_that_are_there_are_so_in_the_first_cycle() -> None:
    drives = [Drive("X"), Drive("Y")]
    assert power_up(*drives).step()
    for drive in drives:
        assert drive.calls == ["place", "SWITCH_ON", "forget"]


@pytest.mark.parametrize("late", [{"power": Power.OFF}, {"is_placed": False}])
@pytest.mark.parametrize("place", [0, 1])
def test_one_that_is_late_is_waited_for_and_named_when_it_takes_too_long(
    late: dict[str, Any], place: int
) -> None:
    drives = [Drive("X"), Drive("Y")]
    drives[place].__dict__.update(late)
    course = power_up(*drives)
    for _ in range(monitor.POWER_UP_CYCLES_MAX):
        assert not course.step()
    assert "forget" not in drives[0].calls
    with pytest.raises(Alarm) as caught:
        course.step()
    assert caught.value.id == 900008
    assert caught.value.values["axis"] == "XY"[place]
    assert int(caught.value.values["ms"]) == 2 * (monitor.POWER_UP_CYCLES_MAX + 1)


@pytest.mark.parametrize(
    ("late", "named"), [("XZ", "X"), ("YZ", "Y"), ("Z", "Z"), ("XYZ", "X"), ("Y", "Y")]
)
def test_of_drives_that_do_not_come_the_first_of_the_channel_is_named(
    late: str, named: str
) -> None:
    """With its own state; the others are in operation, or are late too."""
    drives = [
        Drive(
            name,
            power=Power.OFF if name in late else Power.OPERATING,
            state_name=f"state of {name}",
        )
        for name in "XYZ"
    ]
    watch = power_up(*drives)
    for _ in range(monitor.POWER_UP_CYCLES_MAX):
        assert not watch.step()
    with pytest.raises(Alarm) as caught:
        watch.step()
    assert caught.value.id == 900008
    assert caught.value.values == {
        "axis": named, "state": f"state of {named}", "ms": 2 * (monitor.POWER_UP_CYCLES_MAX + 1),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("reported", "asked", "cycles", "asks"),
    [
        (False, False, monitor.FAULT_CYCLES_MAX, 1),  # nobody has heard of it: asked for once
        (True, False, monitor.FAULT_CYCLES_MAX, 0),
        (True, True, monitor.POWER_UP_CYCLES_MAX, 0),  # it has been asked and may take longer
        (False, True, monitor.POWER_UP_CYCLES_MAX, 1),
    ],
)
def test_a_fault_that_stays_is_an_alarm_after_its_time(
    reported: bool, asked: bool, cycles: int, asks: int
) -> None:
    fault = Drive("Y", is_in_fault=True, has_reported=reported, is_asked=asked, power=Power.OFF)
    course = power_up(Drive("X"), fault)
    for _ in range(cycles):
        assert not course.step()
    with pytest.raises(Alarm) as caught:
        course.step()
    assert (caught.value.id, caught.value.values["axis"]) == (900005, "Y")
    assert fault.calls.count("ask") == asks


@pytest.mark.parametrize("of_all", [True, False])
@pytest.mark.parametrize("of_drive", [True, False])
def test_faults_are_acknowledged_where_the_reset_or_the_list_says_so(
    of_all: bool, of_drive: bool
) -> None:
    drives = [Drive("X"), Drive("Y", settings=SimpleNamespace(fault_reset=of_drive))]
    power_up(*drives, resets_faults=of_all).step()
    assert [drive.acknowledges_faults for drive in drives] == [of_all, of_all or of_drive]


# The watch over a cycle


def alarm(number: int, axis: str) -> Alarm:
    return Alarm(number, axis=axis, statusword="0x0008", emcy="none")


class Part:
    """A link, a carrier and the watch over a drive at once; wrong: what it finds, by its name."""

    def __init__(self, **wrong: Alarm) -> None:
        self._wrong, self.calls, self.holds_back = wrong, list[str](), False

    def _look(self, name: str) -> Alarm | None:
        self.calls.append(name)
        return self._wrong.get(name)

    def take(self) -> None:
        if (found := self._look("take")) is not None:
            raise found

    def check(self) -> Alarm | None:
        return self._look("check")

    def communication(self) -> Alarm | None:
        return self._look("communication")

    def condition(self) -> Alarm | None:
        return self._look("condition")

    def late(self) -> Alarm:
        return self._wrong.get("late", alarm(900005, "late"))

    def __getattr__(self, name: str) -> Any:
        if name not in ("begin", "end", "begin_cycle"):
            raise AttributeError(name)
        return lambda: self.calls.append(name)


def monitor_of(links: list[Part], carriers: list[Part], watches: list[Part]) -> Monitor:
    parts: Any = (links, carriers, watches)
    return Monitor(*parts)


def ids(watch: Monitor, call: str = "take") -> list[str]:
    with pytest.raises(Alarm) as caught:
        getattr(watch, call)()
    return [caught.value.values["axis"], *(each.values["axis"] for each in watch.further)]


def test_each_drive_and_each_sign_of_the_kernel_begins_and_ends() -> None:
    """What the kernel shows of itself begins before the drives are set to watch it."""
    parts: dict[str, list[Any]] = {
        kind: [Part(), Part()] for kind in ("links", "carriers", "drives", "signs")
    }
    watch = Monitor(parts["links"], parts["carriers"], parts["drives"], parts["signs"])

    def calls() -> dict[str, list[list[str]]]:
        return {kind: [each.calls for each in of] for kind, of in parts.items()}

    silent = {"links": [[], []], "carriers": [[], []]}
    watch.prepare()
    assert calls() == {**silent, "drives": [[], []], "signs": [["begin"], ["begin"]]}
    watch.begin()
    assert calls() == {**silent, "drives": [["begin"], ["begin"]], "signs": [["begin"], ["begin"]]}
    watch.end()
    both = [["begin", "end"], ["begin", "end"]]
    assert calls() == {**silent, "drives": both, "signs": both}


def test_the_most_specific_alarm_of_a_cycle_comes_first_and_none_is_lost() -> None:
    """Own controller, SYNC, connection of a drive, telegrams; each link has been taken anyway."""
    links = [Part(take=alarm(900005, "silent")), Part(), Part(take=alarm(900005, "too"))]
    carriers = [Part(), Part(check=alarm(900005, "bus"))]
    watches = [Part(communication=alarm(900005, "drive")), Part()]
    watch = monitor_of(links, carriers, watches)
    carriers[0].holds_back = True
    watch.begin_cycle()
    assert ids(watch) == ["bus", "late", "drive", "silent", "too"]
    assert all("take" in link.calls for link in links)
    carriers[0].holds_back = False
    watch.begin_cycle()
    assert ids(watch) == ["bus", "drive", "silent", "too"]  # this cycle has a SYNC of its own


def test_the_first_segment_whose_cycle_has_not_begun_is_the_one_that_is_named() -> None:
    carriers = [Part(late=alarm(900005, name)) for name in ("one", "two", "three")]
    for carrier in carriers[:2]:
        carrier.holds_back = True
    watch = monitor_of([], carriers, [])
    watch.begin_cycle()
    assert ids(watch) == ["one"]
    watch.take()


def test_only_what_is_wrong_is_an_alarm() -> None:
    watch = monitor_of([Part()], [Part()], [Part(), Part()])
    watch.begin_cycle()
    watch.take()
    watch.check_drives()
    assert watch.further == []
    watches = [Part(), Part(condition=alarm(900005, "Y")), Part(condition=alarm(900005, "Z"))]
    assert ids(monitor_of([], [], watches), "check_drives") == ["Y", "Z"]


def test_every_drive_is_watched_from_the_begin_to_the_end() -> None:
    links, carriers, watches = ([Part(), Part()] for _ in range(3))
    watch = monitor_of(links, carriers, watches)
    watch.begin()
    watch.begin_cycle()
    watch.end()
    assert [part.calls for part in watches] == [["begin", "end"]] * 2
    assert [part.calls for part in (*links, *carriers)] == [["begin_cycle"]] * 4
