"""How far a plant steps: what its axes report, where an edge can be, what can be repeated."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.cosim.fmus_by_hand import RAMP, Fmu

from axisrig.kernel.cosim.fmi.fmu import PlantError
from axisrig.kernel.cosim.plant.plant import Plant, refuse_held_outputs
from axisrig.kernel.errors import UserError
from axisrig.kernel.time.clock import MS, US, TimeNs

FINE_NS = 50 * US
EXCHANGE_NS = 20 * MS
PAIR = ("first", "second")


def axis_fmu(name: str, *, velocity: bool = True, saves: bool = True) -> Any:
    """An axis that stands still."""
    reported = {"velocity": 0.0} if velocity else {}
    fmu: Any = Fmu(*RAMP, position=0.0, **reported)
    fmu.name = name
    fmu.can = SimpleNamespace(can_save_state=saves, fixed_step_s=None)
    fmu.closed = 0
    fmu.close = lambda: setattr(fmu, "closed", fmu.closed + 1)
    return fmu


class Probe:
    """A probe with edges at these instants; free_ns: so far ahead none can be, None = anywhere."""

    def __init__(self, *edges_ns: TimeNs, saves: bool = True, free_ns: TimeNs | None = 0) -> None:
        self.edges_ns, self.free_ns, self.free_until_ns = edges_ns, free_ns, 0
        self.slave: Any = SimpleNamespace(can=SimpleNamespace(can_save_state=saves))
        self.steps: list[tuple[TimeNs, TimeNs]] = []
        self.accepted: list[TimeNs] = []
        self.passed: list[TimeNs] = []

    def start(self, start_ns: TimeNs) -> None:
        self.free_until_ns = start_ns

    def look_ahead(self, now_ns: TimeNs, span_ns: TimeNs) -> TimeNs:
        free_ns = span_ns if self.free_ns is None else min(span_ns, self.free_ns)
        self.free_until_ns = now_ns + free_ns
        return self.free_until_ns

    def step(self, begin_ns: TimeNs, end_ns: TimeNs) -> int:
        self.steps.append((begin_ns, end_ns))
        return sum(begin_ns < edge <= end_ns for edge in self.edges_ns)

    def accept(self, span_ns: TimeNs) -> None:
        self.accepted.append(span_ns)

    def passed_over(self, end_ns: TimeNs) -> None:
        self.passed.append(end_ns)

    def save(self) -> None:
        """Nothing is kept."""

    def restore(self) -> None:
        """Nothing is kept."""


def plant_of(*fmus: Any, **probes: Any) -> Plant:
    plant = Plant(EXCHANGE_NS, FINE_NS)
    for fmu in fmus:
        plant.add_axis(fmu, fmu.roles)
    plant.probes.update(probes)
    plant.initialize()
    return plant


@pytest.mark.parametrize(
    "has_velocity", [(True,), (False,), (True, True), (True, False), (False, True), (False, False),
              (True, False, True)],
)  # fmt: skip
def test_any_axis_that_reports_no_velocity_makes_all_steps_fine(
    has_velocity: tuple[bool, ...],
) -> None:
    """Its speed is a numeric derivative: no base to reckon ahead from."""
    fmus = [axis_fmu(f"axis_{n}", velocity=each) for n, each in enumerate(has_velocity)]
    plant_of(*fmus).advance_to(MS)
    steps = [MS] if all(has_velocity) else [n * FINE_NS for n in range(1, 21)]
    assert [fmu.steps for fmu in fmus] == [steps] * len(fmus)


def test_steps_are_as_long_as_the_exchange_at_most() -> None:
    fmu = axis_fmu("axis_x")
    plant = plant_of(fmu)
    plant.advance_to(50 * MS)
    plant.advance_to(50 * MS)
    plant.advance_to(49 * MS)
    assert (fmu.steps, plant.now_ns) == ([20 * MS, 40 * MS, 50 * MS], 50 * MS)


def test_a_plant_begins_at_the_instant_of_its_start() -> None:
    fmu = axis_fmu("axis_x")
    plant = Plant(EXCHANGE_NS, FINE_NS)
    plant.add_axis(fmu, fmu.roles)
    plant.initialize(3 * MS)
    plant.advance_to(4 * MS)
    assert (fmu.steps, plant.now_ns) == ([4 * MS], 4 * MS)


@pytest.mark.parametrize("exchange_us", [50, 30, 70])
def test_a_fine_step_is_no_longer_than_the_exchange(exchange_us: int) -> None:
    """Where both are the same every step is a fine one."""
    fmu = axis_fmu("axis_x")
    plant = Plant(exchange_us * US, FINE_NS)
    plant.add_axis(fmu, fmu.roles)
    plant.initialize()
    assert plant.fine_ns == min(exchange_us, 50) * US
    plant.advance_to(300 * US)
    step_ns = min(exchange_us, 50) * US
    assert fmu.steps == [*range(step_ns, 300 * US, step_ns), 300 * US]


@pytest.mark.parametrize("near", ["first", "second", "both", "neither"])
def test_one_probe_that_is_near_makes_the_step_fine_and_the_other_is_passed_over(near: str) -> None:
    first, second = (Probe(free_ns=0 if near in (one, "both") else None) for one in PAIR)
    fmu = axis_fmu("axis_x")
    plant_of(fmu, first=first, second=second).advance_to(100 * US)
    steps = [100 * US] if near == "neither" else [50 * US, 100 * US]
    assert fmu.steps == steps
    for probe in (first, second):
        is_followed = probe.free_ns == 0
        assert [end for _, end in probe.steps] == (steps if is_followed else [])
        assert probe.passed == ([] if is_followed else steps)
        assert probe.accepted == ([50 * US] * len(steps) if is_followed else [])


def shortest_ns(probe: Probe) -> TimeNs:
    return min(end - begin for begin, end in probe.steps)


@pytest.mark.parametrize(
    ("edges_ns", "velocity", "shortest"),
    [
        ((), True, 50_000), ((20_001,), True, 3_125), ((50_000,), True, 3_125),
        # two in a part of 3125 ns, and two in different parts
        ((20_001, 20_002), True, 195), ((10_000, 40_000), True, 3_125),
        ((), False, 50_000), ((20_001,), False, 195),
    ],
)  # fmt: skip
def test_a_step_with_an_edge_is_done_again_in_sixteen_parts(
    edges_ns: tuple[TimeNs, ...], velocity: bool, shortest: TimeNs
) -> None:
    """Once more for several edges of a part, or where a speed is a numeric derivative."""
    probe = Probe(*edges_ns)
    fmu = axis_fmu("axis_x", velocity=velocity)
    plant_of(fmu, probe=probe).advance_to(50 * US)
    assert shortest_ns(probe) == shortest
    assert probe.steps[0] == (0, 50_000)
    assert sum(probe.accepted) == 50_000
    assert fmu.time_ns == 50_000
    assert len(probe.accepted) == {50_000: 1, 3_125: 16, 195: 31}[shortest]


@pytest.mark.parametrize(
    ("axes", "probes", "shortest"),
    [
        ((True, True), (True, True), 3_125),
        ((False, True), (True, True), 50_000), ((True, False), (True, True), 50_000),
        ((True, True), (False, True), 50_000), ((True, True), (True, False), 50_000),
    ],
)  # fmt: skip
def test_one_fmu_that_cannot_go_back_leaves_the_step_as_it_is(
    axes: tuple[bool, ...], probes: tuple[bool, ...], shortest: TimeNs
) -> None:
    fmus = [axis_fmu(f"axis_{n}", saves=each) for n, each in enumerate(axes)]
    made = {f"probe_{n}": Probe(20_001, saves=each) for n, each in enumerate(probes)}
    plant_of(*fmus, **made).advance_to(50 * US)
    assert [shortest_ns(probe) for probe in made.values()] == [shortest] * 2


def test_a_probe_that_cannot_go_back_and_is_far_hinders_no_other() -> None:
    near, far = Probe(20_001), Probe(20_001, saves=False, free_ns=None)
    plant_of(axis_fmu("axis_x"), near=near, far=far).advance_to(50 * US)
    assert shortest_ns(near) == 3_125
    assert (far.steps, far.passed) == ([], [50_000])


def test_a_step_below_a_microsecond_is_not_divided() -> None:
    for span_ns, count in ((1_000, 17), (999, 1)):
        probe = Probe(500)
        plant_of(axis_fmu("axis_x"), probe=probe).advance_to(span_ns)
        assert len(probe.steps) == count


def test_the_edges_of_the_probe_with_the_most_count() -> None:
    """Two probes with one edge each in a part are not two edges of one."""
    first, second = Probe(20_001), Probe(20_001)
    plant_of(axis_fmu("axis_x"), first=first, second=second).advance_to(50 * US)
    assert shortest_ns(first) == 3_125
    first, second = Probe(20_001), Probe(20_001, 20_002)
    plant_of(axis_fmu("axis_x"), first=first, second=second).advance_to(50 * US)
    assert shortest_ns(first) == 195


def test_each_instance_is_freed_once() -> None:
    fmus = [axis_fmu("axis_x"), axis_fmu("axis_y")]
    plant = plant_of(*fmus)
    plant.close()
    assert [fmu.closed for fmu in fmus] == [1, 1]


def test_a_sensor_is_wired_to_axes_that_are_there() -> None:
    plant = plant_of(axis_fmu("axis_x"), axis_fmu("axis_y"))
    for add in (plant.add_probe, plant.add_distance):
        sensor: Any = axis_fmu("tip")
        with pytest.raises(UserError, match="plant tip: input z is wired to an unknown axis") as no:
            add(sensor, {"x": "axis_x", "z": "axis_z"}, sensor.roles)
        assert (no.value.value, no.value.allowed) == ("axis_z", "axis_x, axis_y")
    assert (plant.probes, plant.distances) == ({}, {})


@pytest.mark.parametrize("of", ["first", "second"])
def test_axes_of_one_fmu_follow_ramps_by_themselves(of: str) -> None:
    """Both, since the FMU gets its demands for all axes at once."""
    first, second = axis_fmu("axis_x"), axis_fmu("axis_x")
    (first if of == "first" else second).inputs = {"demand": 0.0}
    plant = Plant(EXCHANGE_NS, FINE_NS)
    plant.add_axis(first, first.roles)
    with pytest.raises(UserError, match="plant slave shares the FMU of axis_x") as no:
        plant.add_axis_beside("slave", "axis_x", second.roles)
    assert no.value.value == "slave"
    assert list(plant.axes) == ["axis_x"]


@pytest.mark.parametrize(
    ("free_us", "to_us", "steps_us"),
    [
        # whole fine steps before where an edge can be, or all that is left where none can be
        (130, 240, [100, 200, 240]), (130, 230, [100, 230]), (100, 230, [100, 200, 230]),
        (99, 160, [50, 100, 160]), (50, 120, [50, 100, 120]),
        (49, 120, [50, 100, 120]), (0, 70, [50, 70]), (10_000, 9_999, [9_999]),
    ],
)  # fmt: skip
def test_a_step_goes_over_whole_fine_steps_before_an_edge_can_be(
    free_us: int, to_us: int, steps_us: list[int]
) -> None:
    probe, fmu = Probe(free_ns=free_us * US), axis_fmu("axis_x")
    plant_of(fmu, probe=probe).advance_to(to_us * US)
    assert [step // US for step in fmu.steps] == steps_us
    followed = [end for _, end in probe.steps]
    assert sorted(followed + probe.passed) == fmu.steps
    # what ends later than it is free of edges is followed, also where its begin is free
    spans = zip([0, *fmu.steps], fmu.steps, strict=False)
    assert followed == [end for begin, end in spans if end - begin > free_us * US]


class Sensor:
    """A distance sensor; walks: whether it takes several steps in one call."""

    def __init__(self, *, walks: bool = False) -> None:
        self.walks, self.looks, self.closed = walks, 0, 0
        self.slave: Any = SimpleNamespace(close=lambda: setattr(self, "closed", self.closed + 1))
        self.steps: list[tuple[TimeNs, TimeNs]] = []
        self.walked: list[tuple[TimeNs, list[TimeNs]]] = []

    def start(self, start_ns: TimeNs) -> None:
        """Nothing is looked at."""

    def step(self, begin_ns: TimeNs, end_ns: TimeNs) -> None:
        self.steps.append((begin_ns, end_ns))

    def walk(self, begin_ns: TimeNs, ends_ns: list[TimeNs]) -> None:
        self.walked.append((begin_ns, list(ends_ns)))

    def look(self) -> None:
        self.looks += 1


def sensing(fmu: Any, *sensors: Sensor, fine_us: int = 50, **probes: Any) -> Plant:
    plant = Plant(EXCHANGE_NS, fine_us * US)
    plant.add_axis(fmu, fmu.roles)
    plant.probes.update(probes)
    made: Any = {f"sensor_{n}": sensor for n, sensor in enumerate(sensors)}
    plant.distances.update(made)
    plant.initialize()
    return plant


@pytest.mark.parametrize(("fine_us", "step_us"), [(50, 250), (60, 240), (100, 200), (250, 250)])
@pytest.mark.parametrize("walks", [False, True])
def test_a_plant_with_a_distance_sensor_steps_by_250_us_at_most(
    fine_us: int, step_us: int, walks: bool
) -> None:
    """docs/architecture.md: over it a cubic is within 1 nm of the motion."""
    sensor, fmu = Sensor(walks=walks), axis_fmu("axis_x")
    sensing(fmu, sensor, fine_us=fine_us).advance_to(MS)
    ends = [*range(step_us * US, MS, step_us * US), MS]
    assert fmu.steps == ends
    assert sensor.steps == ([] if walks else list(zip([0, *ends], ends, strict=False)))
    assert sensor.walked == ([(0, ends)] if walks else [])
    assert sensor.looks == 1


def test_a_row_of_steps_goes_on_where_the_last_one_ended() -> None:
    sensor, fmu = Sensor(walks=True), axis_fmu("axis_x")
    plant = sensing(fmu, sensor)
    for end_us in (300, 300, 400):
        plant.advance_to(end_us * US)
    assert sensor.walked == [(0, [250 * US, 300 * US]), (300 * US, [400 * US])]
    assert (sensor.looks, plant.now_ns) == (2, 400 * US)


@pytest.mark.parametrize("walks", [(True, False), (False, True), (False, False), (True, True)])
def test_all_sensors_go_in_a_row_or_none(walks: tuple[bool, bool]) -> None:
    sensors = [Sensor(walks=each) for each in walks]
    sensing(axis_fmu("axis_x"), *sensors).advance_to(500 * US)
    ends = [250 * US, 500 * US]
    for sensor in sensors:
        assert sensor.walked == ([(0, ends)] if all(walks) else [])
        assert [end for _, end in sensor.steps] == ([] if all(walks) else ends)
        assert sensor.looks == 1


def test_beside_a_probe_a_sensor_follows_step_by_step_and_each_part_once() -> None:
    """Parts that are done again are no steps of the sensor."""
    sensor, probe = Sensor(walks=True), Probe(70_001)
    sensing(axis_fmu("axis_x"), sensor, probe=probe).advance_to(100 * US)
    assert sensor.walked == []
    ends = [end for _, end in sensor.steps]
    assert ends == [50_000, *(50_000 + 50_000 * part // 16 for part in range(1, 17))]
    assert [begin for begin, _ in sensor.steps] == [0, *ends[:-1]]
    assert sensor.looks == 1


def test_sensors_are_freed_too() -> None:
    sensors = [Sensor(), Sensor()]
    sensing(axis_fmu("axis_x"), *sensors).close()
    assert [sensor.closed for sensor in sensors] == [1, 1]


@pytest.mark.parametrize(
    "tick",
    [
        (0.1, -0.01, 0.0999995, -0.01),  # 0.5 um downwards in 50 us
        (0.1, -0.01, 0.1, 0.01),  # it turns in the middle of the step
        (0.1, 0.01, 0.1, -0.01), (0.1, -0.01, 0.09999975, 0.0), (0.1, 0.0, 0.0999994, -0.024),
    ],
)  # fmt: skip
def test_a_motion_downwards_or_one_that_turns_is_one_of_the_axis(
    tick: tuple[float, float, float, float],
) -> None:
    refuse_held_outputs(axis_of(tick), 0, 50_000)


@pytest.mark.parametrize(
    ("tick", "moved_um", "speed_mm_s"),
    [((0.1, 0.01, 0.1, 0.01), "0", "10"), ((0.1, -0.01, 0.1, -0.01), "0", "10"),
     ((0.1, 0.02, 0.10001, 0.01), "10", "20"), ((0.1, -0.01, 0.09999, 0.0), "-10", "10"),
     ((0.1, 0.01, 0.09999, -0.02), "-10", "20")],
)  # fmt: skip
def test_a_jump_names_the_axis_its_way_and_its_higher_speed(
    tick: tuple[float, float, float, float], moved_um: str, speed_mm_s: str
) -> None:
    with pytest.raises(PlantError) as caught:
        refuse_held_outputs(axis_of(tick), 1_000_000, 1_050_000)
    words = f"its position moved by {moved_um} um in a step of 50 us with an edge, at {speed_mm_s}"
    assert f"{words} mm/s: it steps inside more coarsely" in str(caught.value)
    assert "axis_x" in str(caught.value)


def axis_of(tick: tuple[float, float, float, float]) -> Any:
    return SimpleNamespace(tick=tick, name="axis_x", slave=SimpleNamespace(name="fmu"))
