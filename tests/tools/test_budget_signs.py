"""A budget in both directions: what is left of a value, its bounds, closed forms of lengths.

The motion of a closed form is x = 100 - 10 t + 1000 t^2 (mm, s) with the contact at 2 ms.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.campaign.results.writer import CaseResult
from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.plan.case import Case
from axisrig.bench.plan.checks import judge
from axisrig.bench.plan.plan import read_plan
from axisrig.bench.plan.select import only
from axisrig.bench.plan.verdict import Verdict
from axisrig.bench.record.signal_sources import STAMPED
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.budget.budget import Budget, make_budget
from axisrig.bench.tools.budget.causes import Active, causes
from axisrig.bench.tools.budget.closed_forms import bound_um, expected_um
from axisrig.bench.tools.budget.observed_run import METRICS, Seen, Track
from axisrig.kernel.time.clock import MS, S

PLANS = Path(__file__).parents[2] / "testplans"
RIGS = PLANS / "rigs"
INCREMENT_UM = 10_000 / 2**20
"""10 mm in a turn of 20 bit."""
BOTH_WAYS = pytest.mark.parametrize("sign", [1, -1])

Values = tuple[float, float, float | None, float | None]
"""Error um, velocity mm/s, latch ms, source error um."""


def latched(*texts: str) -> Case:
    plan = read_plan(PLANS / "latch_accuracy.csv")
    return only(plan.with_inputs([parse_assignment(text) for text in texts]).cases, "f600")


def of_plc(name: str = "plc-f600") -> Case:
    return only(read_plan(PLANS / "plc_sources.csv").cases, name)


def running(
    values: Callable[[Mapping[str, str]], Values], made: list[Case]
) -> Callable[[Sequence[Case]], Iterator[CaseResult]]:
    def run(cases: Sequence[Case]) -> Iterator[CaseResult]:
        made.extend(cases)
        for case in cases:
            there = dict(zip(METRICS, values(case.inputs), strict=True))
            checks = [judge(check, there[check.name]) for check in case.checks]
            facts: Any = SimpleNamespace(frame_log_sha256=case.run)
            yield CaseResult(case, Verdict.PASS, checks, facts=facts)

    return run


def budget(case: Case, *values: float | None) -> Budget:
    """Of a row whose causes all add nothing."""
    given: Any = values
    return make_budget(case, "Z", running(lambda _: given, []))


def last_of(found: Budget) -> tuple[str, float]:
    share = found.shares[-1]
    assert share.alone_um == share.in_turn_um
    return share.cause.cause, pytest.approx(share.in_turn_um)


# What is left


@BOTH_WAYS
def test_the_way_between_the_cycles_is_a_share_whichever_way_the_axis_measures(sign: int) -> None:
    """4 um of error are 3.75 um of way and 0.25 um that nothing explains."""
    found = budget(of_plc(), sign * 4.0, sign * 10.0, None, sign * 0.25)
    assert last_of(found) == ("CNC cycle", sign * 3.75)
    assert found.left_um == pytest.approx(sign * 0.25)
    assert not found.is_explained


@BOTH_WAYS
@pytest.mark.parametrize(("increments", "is_share"), [(1.0, False), (1.001, True), (0.0, False)])
def test_a_way_of_up_to_an_increment_is_no_share(
    sign: int, increments: float, is_share: bool
) -> None:
    way_um = sign * increments * INCREMENT_UM
    found = budget(of_plc(), way_um, sign * 10.0, None, 0.0)
    assert (last_of(found)[0] == "CNC cycle") is is_share
    assert found.left_um == (pytest.approx(0.0) if is_share else way_um)
    assert found.increment_um == INCREMENT_UM


@BOTH_WAYS
def test_where_no_instant_is_known_the_cycles_say_what_may_be_left(sign: int) -> None:
    """1 ms of the CNC and 2 ms of the PLC at 10 mm/s: 30 um; no share is made of it."""
    for error_um, is_explained in ((30.0, True), (30.1, False)):
        found = budget(of_plc(), sign * error_um, sign * 10.0, None, None)
        assert [share.cause.cause for share in found.shares] == ["PLC cycle", "encoder"]
        assert (found.left_um, found.quantum_um) == (sign * error_um, pytest.approx(30.0))
        assert found.is_explained is is_explained


@BOTH_WAYS
def test_the_rounding_of_a_latch_is_a_share_where_no_key_makes_it_finer(sign: int) -> None:
    """10 mm/s for 0.5 ms: 5 um; the other 0.25 um are of the increments."""
    case = replace(latched(), rig=RIGS / "probe-z-sercos.toml", inputs={"plc:V.E.FEED": "600"})
    found = budget(case, sign * 5.25, sign * 10.0, 0.5, None)
    assert last_of(found) == ("encoder", sign * 0.25)
    assert found.left_um == pytest.approx(sign * 5.0)
    assert found.shares[-1].bound_um == found.increment_um
    own = budget(latched(), sign * 5.25, sign * 10.0, 0.5, None)
    assert own.left_um == sign * 5.25  # a run with finer increments has shown what they add


@BOTH_WAYS
def test_what_no_switch_takes_away_has_a_mean_where_others_have(sign: int) -> None:
    """The means add up to the error with it: 6 um where both causes are on, and 9 um of way."""

    def multiplied(inputs: Mapping[str, str]) -> Values:
        both = inputs["plc:period_us"] != "50" and float(inputs["plant:probe.pretravel_um"]) > 0
        return sign * (9.0 + 6.0 * both), sign * 10.0, None, sign * 6.0 * both

    case = of_plc()
    given = {**case.inputs, "plc:period_us": "1000", "plant:probe.pretravel_um": "8"}
    found = make_budget(replace(case, inputs=given), "Z", running(multiplied, []))
    means = {share.cause.cause: share.combined_um for share in found.shares}
    assert means == {
        "pre-travel": pytest.approx(sign * 3.0), "PLC cycle": pytest.approx(sign * 3.0),
        "encoder": pytest.approx(0.0), "CNC cycle": pytest.approx(sign * 9.0),
    }  # fmt: skip
    assert [share.cause.cause for share in found.interacting] == ["pre-travel", "PLC cycle"]
    assert found.left_um == pytest.approx(0.0)


@BOTH_WAYS
def test_a_budget_has_the_numbers_of_the_run_with_all_causes(sign: int) -> None:
    """8 um of pre-travel against the motion, and 1 um beside it."""

    def touched(inputs: Mapping[str, str]) -> Values:
        pretravel_um = float(inputs["plant:probe.pretravel_um"])
        speed_mm_s = sign * (10.0 if pretravel_um else 11.0)
        return sign * (1.0 + pretravel_um), speed_mm_s, 0.5, None

    made: list[Case] = []
    case = latched("plant:probe.pretravel_um=8")
    found = make_budget(case, None, running(touched, made))
    assert (found.run, found.axis) == (case.run, "Z")
    assert (found.error_um, found.velocity_mm_s) == (sign * 9.0, sign * 10.0)
    assert found.frame_log_sha256 == made[0].run
    assert found.left_um == sign * 1.0
    assert found.largest is found.shares[0]
    assert (found.shares[0].alone_um, found.shares[0].in_turn_um) == (sign * 8.0,) * 2
    # The closed form of a length has the sign of the motion
    assert found.shares[0].expected_um == pytest.approx(sign * 8.0)


# The runs


def test_a_run_without_a_cause_has_its_column_once_in_whatever_unit_it_was() -> None:
    made: list[Case] = []
    case = latched("plant:probe.pretravel_mm=0.008", "fault:drop=Z.TPDO1", "drive:servo.node_ms=1")
    given = {name: text for name, text in case.inputs.items() if name != "drive:servo.node_ms"}
    other: Any = ("judged in its own row",)
    case = replace(case, inputs=given, expected=other, sampled=other)
    make_budget(case, "Z", running(lambda _: (0.0, -10.0, 0.5, None), made))
    whole, *others = made
    assert whole.inputs == given
    pretravel = ("plant:probe.pretravel_mm", "plant:probe.pretravel_um")
    found = {tuple(each.inputs.get(name) for name in (*pretravel, "fault:drop")) for each in others}
    assert found == {
        (None, "0", "Z.TPDO1"), (None, "0", None), ("0.008", None, None),
        ("0.008", None, "Z.TPDO1"),
    }  # fmt: skip
    kept = ("plc:V.E.FEED", "plc:V.E.EDGE")
    for each in made:
        assert [each.inputs.get(name) for name in kept] == [given.get(name) for name in kept]
        assert (each.expected, each.sampled) == ((), ())
        assert [str(check.name) for check in each.checks] == list(METRICS)
        assert {check.axis for check in each.checks} == {"Z"}


# Bounds


def seen(**given: Any) -> Seen:
    values = {"error_um": -30.0, "velocity_mm_s": -6.0, "latch_ms": None, "source_um": None,
              "track": track()}  # fmt: skip
    return Seen(**(values | given))


def place_mm(ms: float) -> float:
    return 100 - 10 * ms * 1e-3 + 1000 * (ms * 1e-3) ** 2


def moved_um(begin_ms: float, end_ms: float) -> float:
    """Between two instants after the contact."""
    return (place_mm(2 + end_ms) - place_mm(2 + begin_ms)) * 1e3


def track(contact_ns: int = 2 * MS, touches: int = 1) -> Track:
    speeds = [-10 + 2000 * k * 1e-3 for k in range(9)]
    places = [place_mm(k) for k in range(9)]
    return Track([k * MS for k in range(9)], places, speeds, contact_ns, touches, 0.3)


def active(form: str, value: str = "1") -> Active:
    return Active(next(cause for cause in causes() if cause.form == form), value, "", {})


def on_line(*texts: str) -> Any:
    """A rig with one axis and a stamping terminal on an EtherCAT line."""
    return settings_of(RIGS / "plc-timestamp-line.toml", list(texts))


@BOTH_WAYS
@pytest.mark.parametrize(
    ("drift_ppm", "contact_s", "most_um"),
    [("-100", 2, 2.0), ("100", 2, 2.0), ("terminal=-25", 4, 1.0), ("terminal=25 Z=900", 4, 1.0),
     ("Z=900", 4, 0.0), ("0", 4, 0.0)],
)  # fmt: skip
def test_a_clock_that_nobody_leads_is_off_by_its_drift_since_the_start(
    sign: int, drift_ppm: str, contact_s: int, most_um: float
) -> None:
    """10 mm/s, and 100 ppm of 2 s: 2 um whether it is fast or slow; the clock is the terminal's."""
    rig = on_line("bus:ec1.drift_compensation=false", f"bus:ec1.drift_ppm={drift_ppm}")
    whole = seen(velocity_mm_s=sign * 10.0, track=track(contact_s * S))
    assert bound_um(active("drifted"), rig, "Z", whole, 0.1) == pytest.approx(most_um)
    unknown = seen(velocity_mm_s=sign * 10.0, track=None)
    assert bound_um(active("drifted"), rig, "Z", unknown, 0.1) is None


@BOTH_WAYS
def test_bounds_have_no_sign(sign: int) -> None:
    whole = seen(velocity_mm_s=sign * 10.0)
    for form, value, most_um in (("jitter", "5000", 0.05), ("rounding", "67108864", 0.1)):
        assert bound_um(active(form, value), on_line(), "Z", whole, 0.1) == pytest.approx(most_um)


# Lengths


def probe(**start: object) -> Any:
    plants = {"probe": SimpleNamespace(start=start), "z": SimpleNamespace(start={})}
    axis = SimpleNamespace(probe_1="probe", plant="z", drive="servo")
    return SimpleNamespace(rig=SimpleNamespace(axis={"Z": axis}, plant=plants), start={})


PADS: Mapping[str, object] = {
    "seat_force_n": 6, "stylus_length_mm": 40, "seat_radius_mm": 8, "seat_angle_deg": 15,
    "bending_stiffness_n_m": 1e5, "axial_stiffness_n_m": 1e6, "contact_modulus": 50e9,
    "ball_radius_mm": 3,
}  # fmt: skip
HERTZ_UM = (9 * 6.0**2 / (16 * 3e-3 * 50e9**2)) ** (1 / 3) * 1e6


@pytest.mark.parametrize(
    ("form", "value", "length_um"),
    [("length", "8", 8.0), ("first", "3", 3.0), ("drift", "3", 0.0),
     # Along the axis the three pads share the force: 6 N lift all, and yield 6 N by 1 N/um
     ("seat", "6", 6.0), ("contact", "5e10", HERTZ_UM)],
)  # fmt: skip
@pytest.mark.parametrize(
    ("speed_mm_s", "per_length", "times"), [(-6.0, None, -1.0), (6.0, None, 1.0), (6.0, 0.5, 0.5),
                                            (-6.0, -2.0, -2.0), (-6.0, 0.5, 0.5)],
)  # fmt: skip
def test_a_length_is_beyond_the_contact_in_the_direction_of_the_motion(
    form: str, value: str, length_um: float, speed_mm_s: float, per_length: float | None,
    times: float,
) -> None:  # fmt: skip
    later = seen(latch_ms=1.5, velocity_mm_s=speed_mm_s, per_length=per_length)
    found = expected_um(active(form, value), probe(**PADS), "Z", later, seen())
    assert found == pytest.approx(times * length_um)


@pytest.mark.parametrize("form", ["seat", "contact"])
def test_a_surface_without_one_normal_has_no_closed_form_of_what_yields(form: str) -> None:
    rig = probe(**PADS, **{"workpiece.sine.amplitude_um": 1})
    assert expected_um(active(form), rig, "Z", seen(latch_ms=1.5), seen()) is None
    assert expected_um(active("length", "8"), rig, "Z", seen(latch_ms=1.5), seen()) == -8.0


@pytest.mark.parametrize(
    "form", ["length", "first", "drift", "seat", "contact", "edge", "time", "drawn", "rest"]
)
def test_what_makes_an_edge_later_is_found_by_the_next_cycle(form: str) -> None:
    """Without a latch: the ways to the instants of both values, whatever the cause is set to."""
    later, without = seen(value_ms=3.0), seen(value_ms=1.0)
    found = expected_um(active(form, "5"), probe(**PADS), "Z", later, without)
    assert found == pytest.approx(moved_um(1.0, 3.0))
    assert expected_um(active(form, "5"), probe(**PADS), "Z", later, seen()) is None


@pytest.mark.parametrize(
    ("form", "expected"),
    [("length", -5.0), ("first", -5.0), ("drift", 0.0), ("seat", -6.0), ("contact", -HERTZ_UM),
     ("edge", 0.0), ("time", moved_um(1.0, 3.0))],
)  # fmt: skip
def test_a_stamp_is_of_its_edge_and_waits_for_no_cycle(form: str, expected: float) -> None:
    """A length acts as at a latch; a time is in the stamp."""
    later, without = (seen(value_ms=ms, source=STAMPED) for ms in (3.0, 1.0))
    found = expected_um(active(form, "5"), probe(**PADS), "Z", later, without)
    assert found == pytest.approx(expected)


def test_a_clock_whose_delay_was_not_written_gives_positions_of_before_the_contact() -> None:
    """The wire to the terminal and the slave of the axis: 0.34 ms; their own ends do not count."""
    rig = on_line("bus:ec1.delay_compensation=false", "bus:ec1.wire_ns=Z=900000 terminal=300000",
                  "bus:ec1.slave_ns=Z=40000 terminal=7000")  # fmt: skip
    found = expected_um(active("line"), rig, "Z", seen(value_ms=1.0), seen(value_ms=1.0))
    assert found == pytest.approx(moved_um(0.0, -0.34))


@pytest.mark.parametrize(
    ("frame_us", "sampled_us", "assumed_us", "shift_ms"),
    # Positions that count as of 100 us after their sample are later than they say, and in reverse
    [(0, 50, 150, -0.1), (0, 150, 50, 0.1), (0, 50, 50, 0.0), (400, 50, 350, 0.7),
     (400, 350, 50, -0.7),
     # What is sampled when the frame leaves is in the next one
     (400, 300, 50, -0.75), (400, 50, 300, 0.75)],
)  # fmt: skip
def test_samples_are_assumed_within_the_cycle_before_the_frame(
    frame_us: int, sampled_us: int, assumed_us: int, shift_ms: float
) -> None:
    """SYNC0 at 100 us; a frame at 400 us has a sample at 400 us, 350 us after it that of before."""
    rig = on_line(*(f"bus:ec1.{name}_us={us}" for name, us in (
        ("frame", frame_us), ("shift", 100), ("sample", sampled_us), ("assumed_sample", assumed_us),
    )))  # fmt: skip
    found = expected_um(active("assumed"), rig, "Z", seen(value_ms=1.0), seen(value_ms=1.0))
    assert found == pytest.approx(moved_um(0.0, shift_ms), abs=1e-9)


@pytest.mark.parametrize(
    ("sample_us", "since_ms"),
    # The latch is 3.05 ms after the start, and 1.02 ms after the contact
    [(62.5, 0.05), (80, 0.01), (250, 0.05), (50, 0.0)],
)
@pytest.mark.parametrize("value", ["sampled", "linear"])
def test_samples_of_an_encoder_are_at_multiples_since_the_start(
    sample_us: float, since_ms: float, value: str
) -> None:
    """Whenever the contact is: at 2.03 ms."""
    contact_ms, at_ms = 2.03, 1.02
    touched = track(round(contact_ms * MS))

    def moved(begin_ms: float, end_ms: float) -> float:
        return (place_mm(contact_ms + end_ms) - place_mm(contact_ms + begin_ms)) * 1e3

    rig = settings_of(RIGS / "probe-z.toml", [f"drive:servo.sample_us={sample_us}"])
    later, without = (seen(latch_ms=at_ms, track=touched) for _ in range(2))
    found = expected_um(active("sampling", value), rig, "Z", later, without)
    begin_ms, sample_ms = at_ms - since_ms, sample_us * 1e-3
    on_line_um = moved(begin_ms, begin_ms + sample_ms) * since_ms / sample_ms
    lacks_um = moved(at_ms, begin_ms) + (on_line_um if value == "linear" else 0.0)
    assert found == pytest.approx(lacks_um, abs=1e-6)
