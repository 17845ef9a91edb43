"""A control with its sensor by hand: which sensor, how old it may be, and when its offset goes."""

from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.kernel.channel.distance.axis import AxisDistance
from axisrig.kernel.channel.distance.sensing import source_word
from axisrig.kernel.channel.distance.sensor import SensorSettings
from axisrig.kernel.channel.distance.settings import AxisDistanceSettings
from axisrig.kernel.distance import DistanceCommand, DistanceSettings, DistanceState, Source
from axisrig.kernel.errors import Alarm
from axisrig.kernel.plc.unit import Refreshed
from axisrig.kernel.time.clock import MS

PERIOD_NS = MS
ENCODER, VARIABLE = "SECOND_ENCODER", "VARIABLE"


class Bench:
    """Z with a second encoder at 0.1 um per increment, and variables of the PLC side."""

    def __init__(
        self, *, limit_ms: float | None = None, is_optimized: bool = True, has_second: bool = True,
        **changes: Any,
    ) -> None:  # fmt: skip
        self.link: Any = SimpleNamespace(
            name="Z", actual_mm=0.0, set_mm=0.0, has_second=has_second, second_increments=None,
            second_age_cycles=0, second_period_ns=lambda _cycle_ns: self.promised_ns,
            settings=SimpleNamespace(sensor_age_limit_ms=limit_ms, increments_per_mm=1000.0),
        )  # fmt: skip
        self.promised_ns: int | None = PERIOD_NS
        self.values = {"HEIGHT": 5.0, "OTHER": 10.0}
        self.refreshed: dict[str, Refreshed] = {}
        control = DistanceSettings(v_max_mm_s=100.0, a_max_mm_s2=1e6, max_deviation_mm=10.0)
        control = control.replaced(**changes)
        settings = AxisDistanceSettings(
            control=control, sensor=SensorSettings(), is_optimized=is_optimized
        )
        self.axis = AxisDistance(self.link, settings, self.values, self.refreshed, PERIOD_NS)

    def cycle(self, increments: int | None) -> float:
        """One cycle: take, control, and what is sent with it."""
        self.link.second_increments = increments
        self.axis.take()
        self.axis.step()
        return self.axis.put_out()

    def on(self) -> None:
        self.axis.control.set_surface(0.0)
        self.axis.control.command(DistanceCommand.ON, Source.NC)


def alarm_of(act: Any, *arguments: Any) -> Alarm:
    with pytest.raises(Alarm) as caught:
        act(*arguments)
    return caught.value


# How old


@pytest.mark.parametrize(
    ("promised_ms", "limit_ms", "most_cycles"),
    [(1, None, 3), (4, None, 12), (4, 5.0, 5), (1, 0.5, 0)],
)  # fmt: skip
def test_a_sensor_may_be_silent_for_three_of_its_periods_or_as_the_rig_says(
    promised_ms: int, limit_ms: float | None, most_cycles: int
) -> None:
    bench = Bench(limit_ms=limit_ms)
    bench.promised_ns = promised_ms * MS
    bench.link.second_increments = 7
    bench.link.second_age_cycles = most_cycles
    assert bench.axis.silence() is None
    assert bench.axis.require_sensor() == pytest.approx(0.0007)
    bench.link.second_age_cycles = most_cycles + 1
    silence = bench.axis.silence()
    assert silence is not None
    limit = limit_ms or 3.0 * promised_ms
    assert (silence.source, silence.age_ms, silence.limit_ms) == (ENCODER, most_cycles + 1, limit)
    assert alarm_of(bench.axis.require_sensor).id == 900314


def test_a_sensor_that_promises_nothing_is_never_too_old_and_is_warned_of_once() -> None:
    bench = Bench(limit_ms=1.0)
    bench.promised_ns = None
    bench.link.second_age_cycles = 1000
    assert bench.axis.silence() is None
    warned = []
    for source, variable in (
        (ENCODER, None), (ENCODER, None), (VARIABLE, "HEIGHT"), (VARIABLE, "HEIGHT"),
        (VARIABLE, "V.E.OTHER"), (ENCODER, None),
    ):  # fmt: skip
        bench.axis.choose(source, variable)
        found = bench.axis.age_warning()
        warned.append(found and (found.id, found.values["source"]))
    assert warned == [
        (900315, ENCODER), None, (900315, "VARIABLE V.E.HEIGHT"), None,
        (900315, "VARIABLE V.E.OTHER"), None,
    ]  # fmt: skip


def test_a_variable_that_is_refreshed_has_its_own_period_and_age() -> None:
    bench = Bench()
    bench.axis.choose(VARIABLE, "HEIGHT")
    assert bench.axis.silence() is None
    bench.refreshed["HEIGHT"] = Refreshed(2 * MS, age_cycles=6)
    bench.refreshed["OTHER"] = Refreshed(2 * MS, age_cycles=900)
    assert (bench.axis.silence(), bench.axis.age_warning()) == (None, None)
    bench.refreshed["HEIGHT"].age_cycles = 7
    assert bench.axis.silence() is not None


# Which sensor


def test_a_command_names_another_sensor_or_leaves_the_one_that_is() -> None:
    """SENSOR_VAR alone is a variable; SENSOR_SOURCE=VARIABLE alone is the one of before."""
    bench = Bench()
    sensors = []
    for source, variable in (
        (None, None), (None, "HEIGHT"), (VARIABLE, None), (None, None), (VARIABLE, "V.E.OTHER"),
        (ENCODER, None),
    ):  # fmt: skip
        bench.axis.choose(source, variable)
        sensors.append(source_word(bench.axis.sensor))
    assert sensors == [
        ENCODER, "VARIABLE V.E.HEIGHT", "VARIABLE V.E.HEIGHT", "VARIABLE V.E.HEIGHT",
        "VARIABLE V.E.OTHER", ENCODER,
    ]  # fmt: skip


def test_a_sensor_that_is_chosen_has_its_value_at_once() -> None:
    bench = Bench()
    bench.axis.choose(None, "HEIGHT")
    assert bench.axis.sensor_mm == pytest.approx(0.0005)


@pytest.mark.parametrize(
    ("source", "variable", "alarm_id", "word"),
    [
        (VARIABLE, "GONE", 310027, "VARIABLE V.E.GONE"),
        (VARIABLE, None, 310027, "VARIABLE without SENSOR_VAR"),
        (ENCODER, None, 310029, ENCODER),
    ],
)
def test_a_sensor_that_is_not_there_is_refused_and_the_one_before_stays(
    source: str, variable: str | None, alarm_id: int, word: str
) -> None:
    bench = Bench(has_second=False)
    if source == ENCODER:
        bench.axis.choose(None, "HEIGHT")
    before = source_word(bench.axis.sensor)
    alarm = alarm_of(bench.axis.choose, source, variable)
    assert (alarm.id, alarm.values["source"]) == (alarm_id, word)
    assert source_word(bench.axis.sensor) == before


def test_another_sensor_is_refused_while_control_is_on_and_the_same_one_is_not() -> None:
    bench = Bench()
    bench.axis.choose(None, "HEIGHT")
    bench.on()
    bench.axis.choose(VARIABLE, "V.E.HEIGHT")
    for source, variable, word in (
        (VARIABLE, "OTHER", "VARIABLE V.E.OTHER"), (ENCODER, None, ENCODER),
    ):  # fmt: skip
        alarm = alarm_of(bench.axis.choose, source, variable)
        assert (alarm.id, alarm.values["programmed"]) == (310028, word)
        assert alarm.values["current"] == "VARIABLE V.E.HEIGHT"
    assert source_word(bench.axis.sensor) == "VARIABLE V.E.HEIGHT"


def test_what_another_sensor_has_measured_is_no_reference_for_the_new_one() -> None:
    """REF takes the mean of what the filter remembers: of the sensor in use alone."""
    bench = Bench()
    for _ in range(5):
        bench.cycle(90_000)
    bench.axis.choose(None, "HEIGHT")
    bench.axis.step()
    bench.axis.control.reference(bench.axis.require_sensor())
    assert bench.axis.control.zero_mm == pytest.approx(0.0005)


def test_without_a_value_there_is_no_sensor_yet() -> None:
    bench = Bench()
    assert bench.cycle(None) == 0.0
    assert alarm_of(bench.axis.require_sensor).id == 310029
    bench.link.second_increments = 3
    assert bench.axis.require_sensor() == pytest.approx(0.0003)


# The offset


@pytest.mark.parametrize("is_optimized", [True, False])
def test_an_offset_is_sent_in_its_own_cycle_or_in_the_next_one(is_optimized: bool) -> None:
    """The surface is 50 um below: control comes nearer by the same steps, one cycle later."""
    bench = Bench(is_optimized=is_optimized)
    bench.on()
    sent, computed = [], []
    for _ in range(4):
        sent.append(bench.cycle(-500))
        computed.append(bench.axis.control.offset_mm)
    assert computed[0] != 0.0
    assert sent == (computed if is_optimized else [0.0, *computed[:-1]])


@pytest.mark.parametrize("is_optimized", [True, False])
def test_an_offset_that_is_handed_over_is_the_one_of_this_cycle_and_none_is_left(
    is_optimized: bool,
) -> None:
    bench = Bench(is_optimized=is_optimized)
    bench.on()
    for _ in range(3):
        bench.cycle(-500)
    pending_mm = bench.axis.pending_mm
    assert bench.axis.has_offset
    assert bench.axis.hand_over() == {"Z": pending_mm}
    assert (bench.axis.has_offset, bench.axis.pending_mm, bench.axis.put_out()) == (False, 0.0, 0.0)


def test_an_offset_that_is_computed_and_not_yet_due_is_not_handed_over() -> None:
    """Before this cycle is sent: in order, what the cycle before has computed; else its own."""
    for is_optimized in (True, False):
        bench = Bench(is_optimized=is_optimized)
        bench.on()
        bench.cycle(-500)
        computed = [bench.axis.control.offset_mm]
        bench.link.second_increments = -503
        bench.axis.take()
        bench.axis.step()
        computed.append(bench.axis.control.offset_mm)
        assert computed[0] != computed[1]
        assert bench.axis.hand_over() == {"Z": computed[is_optimized]}
        assert not bench.axis.has_offset


def test_an_offset_is_there_until_the_last_of_it_has_left() -> None:
    bench = Bench(is_optimized=False)
    bench.on()
    bench.cycle(-500)
    bench.axis.control.switch_off_kept()
    bench.axis.control.hand_over()
    states = []
    for _ in range(3):
        states.append((bench.axis.is_idle, bench.axis.is_on_its_way, bench.axis.put_out() != 0.0))
    assert states == [(False, True, True), (False, True, False), (True, False, False)]


@pytest.mark.parametrize(
    ("state", "is_dry_run", "moves"),
    [
        (DistanceState.INACTIVE, False, False), (DistanceState.ACTIVE, False, True),
        (DistanceState.ACTIVE, True, False), (DistanceState.ACTIVE_CONST_DIST, False, True),
        (DistanceState.FREEZE, False, False), (DistanceState.TURNING_OFF, False, True),
        (DistanceState.ERROR, False, False),
    ],
)  # fmt: skip
def test_an_offset_changes_by_itself_in_these_states(
    state: DistanceState, is_dry_run: bool, moves: bool
) -> None:
    bench = Bench()
    bench.axis.control.state, bench.axis.control.is_dry_run = state, is_dry_run
    assert bench.axis.is_moving is moves


@pytest.mark.parametrize("weights", [(0, 0), (0, 1900), (1900, 0), (1900, 1900), (500, 500)])
@pytest.mark.parametrize("way", [1, -1])
def test_the_weights_of_the_way_down_are_permitted_above_a_whole_too(
    weights: tuple[int, int], way: int
) -> None:
    """The surface is 5 mm away: a T^2 = 10 um more in each cycle, up to v T = 40 um, weighted."""
    v_permille, a_permille = weights
    bench = Bench(
        v_max_mm_s=40.0, a_max_mm_s2=1e4, v_weight_down_permille=v_permille,
        a_weight_down_permille=a_permille, max_change_mm_s=1e9, min_pos_mm=-1e3, max_pos_mm=1e3,
    )  # fmt: skip
    bench.on()
    v, a = (each / 1000 if each and way < 0 else 1.0 for each in weights)
    expected_mm = 0.0
    for cycle in range(1, 7):
        expected_mm += way * min(0.01 * a * cycle, 0.04 * v)
        assert bench.cycle(way * 50_000) == pytest.approx(expected_mm)
    assert bench.axis.control.state is DistanceState.ACTIVE


@pytest.mark.parametrize(
    ("variable", "word"),
    [
        ("HEIGHT", "V.E.HEIGHT"), ("V.E.HEIGHT", "V.E.HEIGHT"), ("HEAD.GAP", "V.E.HEAD.GAP"),
        ("V.E.HEAD.GAP", "V.E.HEAD.GAP"), ("V.P.GAP", "V.P.GAP"), ("V.E.VALUE[2]", "V.E.VALUE[2]"),
    ],
)  # fmt: skip
def test_a_variable_is_named_as_a_program_writes_it(variable: str, word: str) -> None:
    bench = Bench()
    alarm = alarm_of(bench.axis.choose, VARIABLE, variable) if "HEIGHT" not in variable else None
    bench.values[word.removeprefix("V.E.")] = 5.0
    bench.axis.choose(VARIABLE, variable)
    assert source_word(bench.axis.sensor) == f"VARIABLE {word}"
    assert alarm is None or alarm.values["source"] == f"VARIABLE {word}"
