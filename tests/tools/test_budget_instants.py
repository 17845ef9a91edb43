"""Instants and encoder noise of a budget, from cycles and positions that are written down.

SYNCs end at 48 us and each ms after; the CNC has its cycle at 600 us, the PLC each 4 ms from 1 ms
on and is busy for 0.5 ms. Positions follow a cubic that is known everywhere.
"""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pyarrow as pa
import pytest
from tests.recordings import facts

from axisrig.bench.judge.latch.truth import Touch
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.record.axes import AxisRecord
from axisrig.bench.record.facts import Timing
from axisrig.bench.record.measuring import PlcTaskRecord
from axisrig.bench.record.series import Series
from axisrig.bench.record.signal_sources import HELD, STAMPED
from axisrig.bench.rig.canopen.keys import DriveTable
from axisrig.bench.tools.budget import observed_run
from axisrig.bench.tools.budget.encoder import (
    between_um,
    history_end_ns,
    is_stamped,
    lost_um,
    noise_number,
    normal_number,
)
from axisrig.bench.tools.budget.instants import Instants, instants_at_plc, is_handed
from axisrig.bench.tools.budget.observed_run import Seen, _whole
from axisrig.kernel.time.clock import MS, US

SYNC_NS = 48 * US
SIGNAL = "PLC"


class Track:
    """What was observed: x = 3 - 2 t + 5 t^2 + c t^3 (mm, ms) at each SYNC."""

    def __init__(self, cubic: float = 0.0, source: str = SIGNAL, **facts: Any) -> None:
        self._cubic = cubic
        task = PlcTaskRecord(
            period_ns=4 * MS, offset_ns=1 * MS, busy_ns=500 * US, terminal_ns=4 * MS,
            terminal_offset_ns=1 * MS,
        )  # fmt: skip
        values = {
            "plc_task": task,
            "timing": SimpleNamespace(period_ns=MS, offset_ns=600 * US),
            "runs": [SimpleNamespace(sources={"Z": source})],
            "faults": [],
            "fine_ns": 50 * US,
        }
        self.facts: Any = SimpleNamespace(**(values | facts))

    def time_ns(self, row: int) -> int:
        return row * MS + SYNC_NS

    def sync_ns(self, _axis: str, row: int) -> int:
        return self.time_ns(row)

    def sync_index_at(self, _axis: str, time_ns: int) -> int:
        return self.index_at(time_ns)

    def index_at(self, time_ns: int) -> int:
        return (time_ns - SYNC_NS) // MS

    def at(self, time_ns: int) -> tuple[float, float]:
        t = time_ns / MS
        x = 3 - 2 * t + 5 * t**2 + self._cubic * t**3
        return x, (-2 + 10 * t + 3 * self._cubic * t**2) * 1e3

    def value(self, _axis: str, name: str, row: int) -> float:
        return self.at(self.time_ns(row))[name == "velocity_mm_s"]


def plc(program: str | None, value: float | None) -> Any:
    task = None if program is None else SimpleNamespace(program=program)
    external = {} if value is None else {"POSITION": value}
    drive = DriveTable(input_filter_us=100.0, input_delay_us=4.0)
    axis = SimpleNamespace(drive="servo", plant="z")
    rig = SimpleNamespace(
        plc_task=task, axis={"Z": axis}, drive={"servo": drive},
        plant={"z": SimpleNamespace(start={})},
    )  # fmt: skip
    return SimpleNamespace(rig=rig, external=external, start={})


@pytest.mark.parametrize(
    ("program", "value", "handed"),
    [
        ("plc/external_latch.py", 1.0, True),
        ("plc/external_latch.py", -2.0, True),
        ("plc/external_latch.py", 0.0, False),
        ("plc/external_latch.py", None, False),
        ("plc/other.py", 1.0, False),
        (None, 1.0, False),
    ],
)
def test_who_hands_a_position_over(program: str | None, value: float | None, handed: bool) -> None:
    assert is_handed(plc(program, value)) is handed


def touched(source: str, edges: tuple[tuple[int, bool], ...], edge_ns: int | None = 0) -> Touch:
    made: Any = SimpleNamespace(
        run=SimpleNamespace(sources={"Z": source}),
        edge_ns=edge_ns,
        edges=[[SimpleNamespace(time_ns=at, level=level) for at, level in edges]],
    )
    return made  # type: ignore[no-any-return]


@pytest.mark.parametrize(
    ("edge_us", "sampled_ms", "value_ms"),
    [
        # edge + 100 us filter + 4 us delay, then the SYNC (48 us, 1048 us ..), the CNC's cycle
        # after it (600 us ..), the cycle of the PLC after that (1, 5, 9 ms), which is done 0.5 ms
        # later; the CNC then has the position of the SYNC before its cycle
        (1000, 2, 5),
        (944, 1, 5),  # 944 + 104 = 1048: the SYNC itself
        (945, 2, 5),
        (4300, 5, 9),  # in the HLI at 5.6 ms: the cycle at 5 ms is over
        (3944, 4, 5),
    ],
)
def test_a_probe_at_a_digital_input_of_the_drive(
    edge_us: int, sampled_ms: int, value_ms: int
) -> None:
    edges = ((edge_us * US, True), (edge_us * US + 90 * MS, False))
    seen = touched(SIGNAL, edges)
    found = instants_at_plc(Track(), seen, "Z", plc(None, None))  # type: ignore[arg-type]
    assert found == Instants(value_ms * MS + SYNC_NS, sampled_ms * MS + SYNC_NS)


@pytest.mark.parametrize(
    ("busy_us", "value_ms"), [(0, 5), (599, 5), (600, 6), (1599, 6), (1600, 7)]
)
def test_a_signal_is_there_for_the_cnc_when_the_plc_is_done(busy_us: int, value_ms: int) -> None:
    """The PLC begins at 5 ms, the CNC at 5.6 ms, 6.6 ms ..: never with what comes as it begins."""
    track: Any = Track()
    track.facts.plc_task = replace(track.facts.plc_task, busy_ns=busy_us * US)
    found = instants_at_plc(track, touched(SIGNAL, ((1000 * US, True),)), "Z", plc(None, None))
    assert found == Instants(value_ms * MS + SYNC_NS, 2 * MS + SYNC_NS)


def test_a_pulse_that_the_filter_holds_back_gives_nothing() -> None:
    edges = ((1000 * US, True), (1099 * US, False))
    assert instants_at_plc(Track(), touched(SIGNAL, edges), "Z", plc(None, None)) is None  # type: ignore[arg-type]


def test_a_position_that_is_handed_over_is_of_the_cycle_before() -> None:
    """The PLC at 5 ms hands over what the CNC has shown at 4.6 ms: the SYNC at 4.048 ms."""
    seen = touched(HELD, ((1000 * US, True),))
    handed = instants_at_plc(Track(), seen, "Z", plc("external_latch.py", 1.0))  # type: ignore[arg-type]
    assert handed == Instants(4 * MS + SYNC_NS, 2 * MS + SYNC_NS)
    plain = instants_at_plc(Track(), seen, "Z", plc("external_latch.py", 0.0))  # type: ignore[arg-type]
    assert plain == Instants(5 * MS + SYNC_NS, 2 * MS + SYNC_NS)


def test_instants_that_are_not_known() -> None:
    edges = ((1000 * US, True),)
    for track, seen in (
        (Track(plc_task=None), touched(SIGNAL, edges)),
        (Track(), touched(SIGNAL, edges, None)),
        (Track(), touched("DRIVE", edges)),
        (Track(), touched("", edges)),
    ):
        assert instants_at_plc(track, seen, "Z", plc(None, None)) is None  # type: ignore[arg-type]


# --- positions


def test_a_cubic_is_off_by_nothing_and_a_drive_that_steps_by_what_it_lacks() -> None:
    """Through two SYNCs on either side; the truth between is a cubic with its speeds at both."""
    at_ns = 5 * MS + SYNC_NS + 300 * US
    for cubic in (0.0, 0.7):
        assert between_um(Track(cubic), "Z", at_ns) == pytest.approx(0.0, abs=1e-6)  # type: ignore[arg-type]
    assert history_end_ns(Track(), "Z", at_ns) == 7 * MS + SYNC_NS  # type: ignore[arg-type]

    class Bent(Track):
        def at(self, time_ns: int) -> tuple[float, float]:
            t = time_ns / MS - SYNC_NS / MS
            return t**4, 4 * t**3 * 1e3

    # At t = 5.3 between 4, 5, 6, 7: Lagrange lacks (t-4)(t-5)(t-6)(t-7), Hermite (t-5)^2 (t-6)^2
    lagrange, hermite = 1.3 * 0.3 * -0.7 * -1.7, 0.3**2 * 0.7**2
    assert between_um(Bent(), "Z", at_ns) == pytest.approx((hermite - lagrange) * 1e3, rel=1e-6)  # type: ignore[arg-type]


def test_positions_are_of_the_syncs_of_their_own_segment() -> None:
    """Every second one is 64 us later than the first segment's; a cubic lacks nothing there."""
    track, rows = Track(0.7), range(12)
    columns = {
        "time_ns": [track.time_ns(row) for row in rows],
        "Z.truth_mm": [track.value("Z", "truth_mm", row) for row in rows],
        "Z.velocity_mm_s": [track.value("Z", "velocity_mm_s", row) for row in rows],
        "Z.sync_after_ns": [64 * US * (row % 2) for row in rows],
    }
    mark = SimpleNamespace(marks=[(track.time_ns(5), "drop Z.TPDO1: 1 frame hit")])
    timed = Timing(MS, 600 * US, 0)
    axes = {"Z": AxisRecord("can1", 1, 1000.0, plant="z")}
    found = facts(timing=timed, end_ns=11 * MS, axes=axes, runs=track.facts.runs, faults=(mark,))
    observed = Observed(found, Series(pa.table(columns)))
    at_ns = track.time_ns(5) + 300 * US
    assert between_um(observed, "Z", at_ns) == pytest.approx(0.0, abs=1e-6)
    own_ns = track.time_ns(5) + 64 * US
    assert lost_um(observed, "Z", own_ns, is_latched=False) == pytest.approx(0.0, abs=1e-6)
    assert history_end_ns(observed, "Z", at_ns) == track.time_ns(7) + 64 * US
    # Between the SYNC of the first segment and its own: still the cycle before
    assert history_end_ns(observed, "Z", own_ns - 1) == track.time_ns(6)


@pytest.mark.parametrize(
    ("row", "marks", "off"),
    [
        (5, [(5, "drop Z.TPDO1: 1 frame hit")], True),
        (5, [(6, "drop Z.TPDO1: 2 frames hit, the last")], True),
        (5, [(6, "drop Z.TPDO1: 1 frame hit")], False),
        (5, [(4, "drop Z.TPDO1: 3 frames hit, the last")], False),
        (5, [(5, "drop Z.TPDO1 begins"), (5, "drop Z.TPDO1 ends")], False),
        (5, [(5, "drop Z.TPDO1 begins"), (5, "drop Z.TPDO1: 1 frame hit")], True),
    ],
)
def test_a_position_of_a_lost_telegram(row: int, marks: list[tuple[int, str]], off: bool) -> None:
    """t^4 by the SYNCs: of one lost at 5 the cubic through 3, 4, 6, 7 lacks 4, of two as well."""

    class Bent(Track):
        def at(self, time_ns: int) -> tuple[float, float]:
            return (time_ns / MS - SYNC_NS / MS) ** 4, 0.0

    fault = SimpleNamespace(marks=[(ms * MS + SYNC_NS, words) for ms, words in marks])
    track: Any = Bent(faults=[fault])
    at_ns = row * MS + SYNC_NS
    last = marks[0][0]
    rows = [3, 4, 6, 7] if last == 5 else [3, 4, 7, 8]
    lacks = -math.prod(row - each for each in rows) if off else 0.0
    assert lost_um(track, "Z", at_ns, is_latched=False) == pytest.approx(lacks * 1e3, abs=1e-6)
    assert lost_um(track, "Z", at_ns, is_latched=True) == 0.0
    stamped: Any = Bent(source=STAMPED, faults=[fault])
    assert lost_um(stamped, "Z", at_ns, is_latched=False) == 0.0


# --- noise


def test_numbers_of_a_seed_by_their_generators() -> None:
    """Park and Miller step by step, Box and Muller of both; 0 before the first."""
    modulus = 2**31 - 1
    for seed in (1, 7):
        a = (1 + 742938285 * seed % (modulus - 1)) % modulus
        b = (1 + 950706376 * seed % (modulus - 1)) % modulus
        assert normal_number(0, seed) == normal_number(-3, seed) == 0.0
        for place in range(1, 6):
            a, b = 16807 * a % modulus, 48271 * b % modulus
            normal = math.sqrt(-2 * math.log(a / modulus)) * math.cos(2 * math.pi * b / modulus)
            assert normal_number(place, seed) == pytest.approx(normal)


def noisy(**start: object) -> Any:
    settings = plc(None, None)
    settings.rig.plant["z"].start = start
    return settings


def test_the_noise_of_an_instant() -> None:
    """A number each 100 us; a drive has a cubic between fine steps of 50 us, or their 16 parts."""
    track: Any = Track()
    value_ns = 5 * MS + SYNC_NS + 260 * US  # 5.308 ms: number 53
    assert noise_number(track, "Z", noisy(), value_ns, None) == 0.0
    on = noisy(noise_um=0.1)
    assert noise_number(track, "Z", on, value_ns, None) == normal_number(53, 1)
    other = noisy(noise_um=0.1, seed=4, noise_period_us=250)
    assert noise_number(track, "Z", other, value_ns, None) == normal_number(21, 4)
    # The edge in another fine step: from 5.298 to 5.348 ms, that is number 52 to 53
    share = 10 / 50
    first, last = normal_number(52, 1), normal_number(53, 1)
    expected = first + (last - first) * (3 * share**2 - 2 * share**3)
    assert noise_number(track, "Z", on, value_ns, value_ns - MS) == pytest.approx(expected)
    # In the same one a part is 3.125 us: 5.30738 to 5.3105 ms are both number 53
    same = noise_number(track, "Z", on, value_ns, value_ns - 5 * US)
    assert same == pytest.approx(normal_number(53, 1))
    assert not is_stamped(track, "Z")


class Ramp(Track):
    """v = v0 + a t at each SYNC (mm/s, mm/s2), from 0 at t = 0."""

    def __init__(self, speed_mm_s: float, acceleration_mm_s2: float, **facts: Any) -> None:
        super().__init__(**facts)
        self._motion = speed_mm_s, acceleration_mm_s2

    def at(self, time_ns: int) -> tuple[float, float]:
        (v, a), t = self._motion, time_ns / MS / 1e3
        return v * t + a * t**2 / 2, v + a * t


def whole_of(speed_mm_s: float, acceleration_mm_s2: float, **more: Any) -> Seen:
    """What a run shows of a touch 3 ms after the begin, whose drive latches 2 ms later."""
    return whole_of_track(Ramp(speed_mm_s, acceleration_mm_s2), speed_mm_s, **more)


def whole_of_track(
    observed: Track, speed_mm_s: float, latch_ms: float | None = 2.0, **more: Any
) -> Seen:
    settings = plc(None, None)
    settings.rig.plant["z"].start = more.get("start", {})
    settings.rig.axis["Z"].probe_1 = "probe"
    settings.rig.axis["X"] = SimpleNamespace(plant="x")
    settings.rig.plant["probe"] = SimpleNamespace(start={}, wire={"z": "z"})
    sources = observed.facts.runs[-1].sources
    run = SimpleNamespace(sources=sources, signal_ns=more.get("signal_ns"))
    contact = SimpleNamespace(time_ns=3 * MS + SYNC_NS)
    touch: Any = SimpleNamespace(run=run, contact=contact, edge_ns=contact.time_ns)
    track: Any = observed
    return _whole(track, touch, "Z", settings, Seen(-1.0, speed_mm_s, latch_ms, None, None))


class RunUp(Ramp):
    """Gains speed until 4.2 ms, and goes on with what it has then."""

    def at(self, time_ns: int) -> tuple[float, float]:
        (v, a), t = self._motion, time_ns / MS / 1e3
        run_up_s = min(t, 4.2e-3)
        speed_mm_s = v + a * run_up_s
        return v * run_up_s + a * run_up_s**2 / 2 + speed_mm_s * (t - run_up_s), speed_mm_s


def test_speed_is_gained_at_the_contact_whatever_comes_until_the_value() -> None:
    """The contact is at 3 ms, the latch at 5 ms: there the speed is steady again."""
    assert whole_of_track(RunUp(10.0, 5000.0), 30.0).gains_speed
    assert whole_of_track(RunUp(-10.0, -5000.0), -30.0).gains_speed
    assert not whole_of_track(RunUp(30.0, 0.0), 30.0).gains_speed


@pytest.mark.parametrize(("signal_ms", "is_after"), [(6.9, True), (7.0, False), (4.9, True)])
def test_a_stamp_is_of_after_the_signal_where_one_of_its_positions_is(
    signal_ms: float, is_after: bool
) -> None:
    """A cubic through SYNCs 4 to 7, in place of the one until SYNC 5."""
    signal_ns = round(signal_ms * MS) + SYNC_NS
    stamped = whole_of_track(Ramp(-10.0, 0.0, source=STAMPED), -10.0, signal_ns=signal_ns)
    assert stamped.is_after_signal is is_after
    assert stamped.source == STAMPED
    latched = whole_of(-10.0, 0.0, signal_ns=signal_ns)
    assert latched.is_after_signal is (signal_ms < 5)


@pytest.mark.interpreted
def test_noise_of_a_value_of_a_plc_is_that_of_its_instant_whatever_the_edge(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A drive that latches has a cubic between fine steps; a PLC takes the position as it is."""
    value_ns = 5 * MS + SYNC_NS + 260 * US  # 5.308 ms: number 53 of 100 us each
    sampled_ns = 4 * MS + SYNC_NS
    monkeypatch.setattr(observed_run, "instants_at_plc", lambda *_: Instants(value_ns, sampled_ns))
    noise = {"noise_um": 0.1}
    found = whole_of_track(Ramp(-10.0, 0.0), -10.0, None, start=noise)
    assert found.noise == normal_number(53, 1)
    assert (found.value_ms, found.sampled_ms) == (pytest.approx(2.26), pytest.approx(1.0))
    latched = whole_of_track(Ramp(-10.0, 0.0), -10.0, 2.26, start=noise)
    share = 10 / 50
    first, last = normal_number(52, 1), normal_number(53, 1)
    assert latched.noise == pytest.approx(first + (last - first) * (3 * share**2 - 2 * share**3))


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("speed_mm_s", "acceleration_mm_s2", "gains"),
    [
        (10.0, 1000.0, True),
        (10.0, -1000.0, False),  # 7 and 6 mm/s: it brakes
        (10.0, 0.0, False),
        (10.0, 19.0, False),  # 1.9 of 1000 in a cycle: a step of the set position by an increment
        (10.0, 21.0, True),
    ],
)
def test_an_axis_gains_speed_whichever_way_it_goes(
    speed_mm_s: float, acceleration_mm_s2: float, gains: bool, side: float
) -> None:
    assert whole_of(side * speed_mm_s, side * acceleration_mm_s2).gains_speed is gains


@pytest.mark.parametrize(
    ("signal_ns", "is_after"),
    [(None, False), (5 * MS + SYNC_NS - 1, True), (5 * MS + SYNC_NS, False)],
)
def test_a_value_of_after_the_signal_is_of_an_axis_that_brakes(
    signal_ns: int | None, is_after: bool
) -> None:
    found = whole_of(-10.0, 0.0, signal_ns=signal_ns)
    assert found.is_after_signal is is_after
    assert (found.value_ms, found.sampled_ms, found.source) == (2.0, None, SIGNAL)
    assert found.per_length == -1.0  # straight down onto a plane


def test_the_noise_of_a_stamp_is_that_of_four_syncs() -> None:
    """Weights of a cubic at 0.3 between the second and the third of them."""
    track: Any = Track(source=STAMPED)
    assert is_stamped(track, "Z")
    value_ns = 5 * MS + SYNC_NS + 300 * US
    weights = [-0.0595, 0.7735, 0.3315, -0.0455]
    assert sum(weights) == pytest.approx(1.0)
    numbers = [normal_number(place, 1) for place in (40, 50, 60, 70)]
    expected = sum(w * n for w, n in zip(weights, numbers, strict=True))
    found = noise_number(track, "Z", noisy(noise_um=0.1), value_ns, value_ns)
    assert found == pytest.approx(expected)
