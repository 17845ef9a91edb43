"""Edges and contacts as an FMU counts them: one step, each once, in the order of their times."""

import ctypes
from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.fmus_by_hand import GROUPS, Fmu, Values

from axisrig.kernel.cosim.fmi.library import PlantError
from axisrig.kernel.cosim.plant.edges import LocatingProbe, make_probe
from axisrig.kernel.time.clock import US

EDGES = ("rising_count", "falling_count", "rising_time", "falling_time")
CONTACTS = ("contact_count", "contact_time", "contact_z")
INPUTS = ("step_time", "step_size", "z_start", "z_rate_start", "z_end", "z_rate_end")


class Counts(Values):
    """Whole numbers of an FMU."""

    def __init__(self, fmu: Fmu, names: tuple[str, ...]) -> None:
        super().__init__(fmu, names)
        self.values = (ctypes.c_int32 * len(names))()

    def read(self) -> None:
        self.values[:] = [int(self._fmu.value(name)) for name in self._names]


class Locating(Fmu):
    """An FMU that gets the way of a step; up, down, touched: instants of its edges, us."""

    def __init__(self, up: Any = (), down: Any = (), touched: Any = None, level: float = 0.0):
        def count(instants: Any) -> Any:
            return lambda ns: float(sum(each * US <= ns for each in instants))

        def last(instants: Any) -> Any:
            return lambda ns: max((each * 1e-6 for each in instants if each * US <= ns), default=0)

        outputs = {
            "signal": level, "rising_count": count(up), "falling_count": count(down),
            "rising_time": last(up), "falling_time": last(down),
        }  # fmt: skip
        if touched is not None:
            outputs |= {
                "contact_count": count(touched), "contact_time": last(touched),
                "contact_z": lambda ns: ns * 1e-9,
            }  # fmt: skip
        super().__init__(*INPUTS, **outputs)
        self.roles.exchange = self._exchange

    def _exchange(self, names: Any) -> Values:
        kind = Counts if names[0].endswith("_count") else Values
        return kind(self, tuple(names))

    def _has_group(self, group: str) -> bool:
        more = {"edges": EDGES, "contact": CONTACTS}
        return self._has(*(more[group] if group in more else GROUPS[group]))

    def function(self, _name: str, _signature: Any) -> Any:
        raise AssertionError("what is no plain exchange takes no steps in a row")

    def names(self, _causality: str) -> list[str]:
        return list(self.inputs)


def probe_of(fmu: Locating) -> LocatingProbe:
    axis: Any = SimpleNamespace(
        motion=[0.0] * 8, tick=(1.0, 2.0, 3.0, 4.0), tells_velocity=True,
        name="axis_z",
    )  # fmt: skip
    probe = make_probe(fmu.roles, {"z": axis})
    assert isinstance(probe, LocatingProbe)
    probe.start(0)
    return probe


@pytest.mark.parametrize(
    ("up", "down", "level", "edges"),
    [
        ((30,), (), 0.0, [(30, True)]), ((), (30,), 1.0, [(30, False)]),
        ((30,), (70,), 0.0, [(30, True), (70, False)]),
        ((70,), (30,), 1.0, [(30, False), (70, True)]),
        ((150,), (120,), 1.0, [(120, False), (150, True)]),
        ((30, 170), (120,), 0.0, [(30, True), (120, False), (170, True)]),
    ],
)  # fmt: skip
def test_edges_come_in_the_order_of_their_times_and_once(
    up: tuple[int, ...], down: tuple[int, ...], level: float, edges: list[tuple[int, bool]]
) -> None:
    fmu = Locating(up, down, level=level)
    probe = probe_of(fmu)
    assert probe.signal.level is bool(level)
    heard: list[int] = []
    probe.signal.watches.append(heard.append)
    for begin in (0, 100, 200):
        most = probe.step(begin * US, (begin + 100) * US)
        new = [each for each in edges if begin < each[0] <= begin + 100]
        rising = sum(is_high for _, is_high in new)
        assert most == max(rising, len(new) - rising)
        probe.accept(100 * US)
        known = [each for each in edges if each[0] <= begin + 100]
        assert probe.signal.edges == [(at * US, is_high) for at, is_high in known]
        assert probe.signal.level is (known[-1][1] if known else bool(level))
        way = [fmu.inputs[name] for name in INPUTS]
        assert way == pytest.approx([begin * 1e-6, 100e-6, 1.0, 2.0, 3.0, 4.0])
    assert heard == [at * US for at, _ in edges]
    assert probe.edge_uncertainty_ns == 1.0


@pytest.mark.parametrize(
    ("up", "down", "touched"),
    [
        ((20, 60), (40,), None), ((20, 40), (), ()), ((), (20, 40), ()),
        ((50,), (), (20, 40)),  # two contacts
    ],
)  # fmt: skip
def test_two_of_any_kind_in_a_step_are_not_both_known(
    up: tuple[int, ...], down: tuple[int, ...], touched: tuple[int, ...] | None
) -> None:
    """Rising edges, falling ones, and contacts."""
    probe = probe_of(Locating(up, down, touched=touched))
    assert probe.step(0, 100 * US) == 2
    with pytest.raises(PlantError, match="2 edges of one direction inside one step"):
        probe.accept(100 * US)


def test_a_contact_is_kept_with_its_instant_and_place() -> None:
    probe = probe_of(Locating((50,), (), touched=(40, 240)))
    for begin in (0, 100, 200):
        probe.step(begin * US, (begin + 100) * US)
        probe.accept(100 * US)
    assert [(each.time_ns, dict(each.position_mm)) for each in probe.contacts] == [
        (40 * US, {"axis_z": pytest.approx(0.1)}), (240 * US, {"axis_z": pytest.approx(0.3)}),
    ]  # fmt: skip
    assert probe.signal.edges == [(50 * US, True)]


def test_edges_of_before_the_begin_are_none() -> None:
    fmu = Locating((-10,), (), touched=(-5,))
    probe = probe_of(fmu)
    assert probe.step(0, 100 * US) == 0
    probe.accept(100 * US)
    assert (probe.signal.edges, probe.contacts) == ([], [])


def test_a_contact_has_the_place_of_each_axis_also_of_two_on_one_fmu() -> None:
    """As the FMU of the probe reports them, by the names of the axes in the rig."""
    fmu = Locating((30,), touched=(30,))
    fmu.outputs |= {"contact_x": lambda _ns: 0.25, "contact_z": lambda _ns: -0.5}
    of_both = SimpleNamespace(name="table")
    axes: Any = {
        group: SimpleNamespace(motion=[0.0] * 8, tick=(0.0, 0.0, 0.0, 0.0), tells_velocity=True,
                               slave=of_both, name=name)
        for group, name in (("x", "table"), ("z", "table2"))
    }  # fmt: skip
    probe = make_probe(fmu.roles, axes)
    probe.start(0)
    probe.step(0, 100 * US)
    probe.accept(100 * US)
    (contact,) = probe.contacts
    assert contact.position_mm == {"table": 250.0, "table2": -500.0}
