"""Limits of testplans/ethercat.csv from closed forms; nothing of the bench is imported.

Rigs, programs and plan are read as the text files they are. Lengths in mm, v in mm/s, times in s
where no unit ends the name. T is the period of the cycles.
"""

import math
import re

import pytest
from tests.plans.shipped_files import PLANS, limits, rig_of, rows_of

ROWS = rows_of("ethercat")
RIG = rig_of(PLANS / "rigs" / "probe-z-ethercat.toml")
DELAY_S = RIG["drive"]["servo"]["input_delay_us"] * 1e-6
T = RIG["cycle"]["period_us"] * 1e-6
KV = RIG["plant"]["z"]["start"]["kv"]
INCREMENT_MM = RIG["drive"]["servo"]["lead_mm"] / RIG["drive"]["servo"]["encoder_increments"]
SURFACE_MM = 100.0
APPROACH_MM = 110.374  # N10 of probe-z.nc: the run begins there
ACCELERATION = 1000.0  # P-AXIS-00008 of axis-z-fine.lst
MISSING = 3  # missing_cycles, its default
WATCHDOG_S = 0.1  # 0400 and 0420 at power on: 1000 units of 100 us
WRAP_S = 2**32 * 1e-9
START_MAX_S = 0.2
"""A start-up takes no longer: some 100 frames of one each ms."""


def speed(case: str) -> float:
    return float(ROWS[case]["plc:V.E.FEED"]) / 60


def condition(case: str, metric: str) -> str:
    """A cell of the column, or of the column `checks`."""
    row = ROWS[case]
    if row.get(f"check:{metric}"):
        return row[f"check:{metric}"]
    for part in row["checks"].split(" ;; "):
        if re.match(rf"{re.escape(metric)} (=|<|>)", part):
            return part.removeprefix(metric).strip().removeprefix("= ")
    raise AssertionError(f"{case} does not check {metric}")


def given(case: str, name: str) -> str:
    """A value of the column `inputs`; "" where it has none."""
    found = re.search(rf"(?:^|;; ){re.escape(name)}=(.*?)(?: ;; |$)", ROWS[case]["inputs"])
    return found[1] if found else ""


def is_exact(case: str, metric: str, expected_um: float) -> bool:
    """Whether a band is the closed form, an increment wide on each side."""
    low, high = limits(condition(case, metric))
    width = (high - low) / 2
    middle = (low + high) / 2
    return abs(middle - expected_um) < 1e-4 and abs(width - INCREMENT_MM * 1e3) < 1e-4


LATCHED = [
    case for case, row in ROWS.items()
    if row["check:latch_error_um"] and row["program"].endswith("probe-z.nc")
    and row["rig"].endswith(("probe-z-ethercat.toml", "plc-timestamp-ethercat.toml",
                             "probe-z-ethercat-fixed.toml"))
    and "PLC_TIMESTAMP" not in row["inputs"] and "profile=" not in row["inputs"]
]  # fmt: skip


@pytest.mark.parametrize("case", LATCHED)
def test_a_latch_is_v_times_the_delay_of_the_input_past_the_contact(case: str) -> None:
    """Whatever became of frames, counters and clocks meanwhile."""
    assert is_exact(case, "latch_error_um", -speed(case) * DELAY_S * 1e3)


PLAIN = ["f60", "f600", "f3000", "neg-f600", "in2-f600"]


def overtravel_mm(v: float) -> tuple[float, float]:
    """From the contact on: input delay, the sample that has it, and the way of the reaction.

    The first SYNC0 after the latch is 0 to T later; the frame that brings it, the NC cycle, the
    frame with its set value and the SYNC0 at which that acts are 2 T. Then v/Kv of lag and v²/2a of
    the ramp.
    """
    least_s, most_s = 2 * T + DELAY_S, 3 * T + DELAY_S
    stop = v / KV + v * v / (2 * ACCELERATION)
    return v * least_s + stop, v * most_s + stop


@pytest.mark.parametrize("case", PLAIN)
def test_reaction_and_overtravel_have_one_cycle_more_than_on_can(case: str) -> None:
    """SYNC0 at 100 us, the next frame at 1000, its NC cycle at 1600: 1.5 T to 2.5 T."""
    sync_s = 100e-6  # shift_us, its default
    to_cycle_s = T - sync_s + RIG["cycle"]["cycle_offset_us"] * 1e-6
    low, high = limits(condition(case, "reaction_ms"))
    assert low == pytest.approx((to_cycle_s + DELAY_S) * 1e3)
    assert high == pytest.approx((to_cycle_s + DELAY_S + T) * 1e3)
    low, high = limits(condition(case, "contact_to_latch_ms"))
    assert (low + high) / 2 == pytest.approx(DELAY_S * 1e3)
    assert limits(condition(case, "overtravel_mm")) == pytest.approx(
        overtravel_mm(speed(case)), abs=1.1e-5
    )


@pytest.mark.parametrize(
    ("case", "cycles"),
    [("latch-frame-lost-1", 1), ("latch-frame-lost-2", 2), ("latch-frame-late", 1),
     ("latch-frame-corrupt", 1), ("counter-wrong-1", 1), ("late-in-time", 0)],
)  # fmt: skip
def test_each_frame_of_the_latch_that_does_not_count_is_v_t_of_overtravel(
    case: str, cycles: int
) -> None:
    usual = limits(condition("f3000", "overtravel_mm"))
    more_mm = speed(case) * T * cycles
    assert limits(condition(case, "overtravel_mm")) == pytest.approx([x + more_mm for x in usual])
    assert condition(case, "alarms") == "none"


def test_frames_that_leave_later_and_the_clock_that_they_lead_move_the_way_by_no_more() -> None:
    """All leave before SYNC0; SYNC0 follows the time in them, which is older by as much at most."""
    late_us = re.findall(r"=(\d+)us", given("frame-jitter", "fault:line_late"))
    late_s = sum(map(int, late_us)) * 1e-6
    assert late_s < 100e-6  # shift_us, its default
    v = speed("frame-jitter")
    low, high = limits(condition("f3000", "overtravel_mm"))
    assert limits(condition("frame-jitter", "overtravel_mm")) == pytest.approx(
        (low - v * late_s, high + v * late_s)
    )


@pytest.mark.parametrize(
    ("case", "alarm"),
    [("frames-lost-4", 900730), ("frames-corrupt-4", 900730), ("counter-wrong-4", 900731),
     ("counter-wrong-3", None)],
)  # fmt: skip
def test_the_cycle_after_missing_cycles_is_the_alarm(case: str, alarm: int | None) -> None:
    count = int(re.search(r"count=(\d+)", ROWS[case]["inputs"])[1])  # type: ignore[index]
    assert count == MISSING + (alarm is not None)
    assert condition(case, "alarms") == (f"== {alarm}" if alarm else "none")


def test_a_fall_just_before_the_contact_lets_the_drive_latch_in_safeop() -> None:
    """The contact is 4 ms later, and the ramp of a fault lasts v/a longer: 50 mm/s, 5000 mm/s2."""
    moment = re.search(r"motion\+(\d+)ms nth=2", ROWS["slave-falls-before"]["inputs"])
    assert moment is not None
    v = speed("slave-falls-before")
    way_s = (APPROACH_MM - SURFACE_MM) / v + v / (2 * ACCELERATION) + 1 / KV
    before_s = way_s - float(moment[1]) * 1e-3
    assert 2 * T < before_s < v / 5000
    assert condition("slave-falls-before", "alarms") == "== 900732"
    assert condition("slave-falls-before", "probe_deflection_mm_max").startswith(">= 0.0")


@pytest.mark.parametrize("case", ["watchdog-98", "watchdog-101"])
def test_the_watchdog_runs_out_between_two_outputs(case: str) -> None:
    count = int(re.search(r"count=(\d+)", ROWS[case]["inputs"])[1])  # type: ignore[index]
    runs_out = (count + 1) * T > WATCHDOG_S
    assert abs((count + 1) * T - WATCHDOG_S) >= 0.9 * T
    assert int(given(case, "drive:servo.missing_cycles")) > count
    assert condition(case, "alarms") == ("== 900732" if runs_out else "none")


WRAPPED = ["stamp-wrap", "stamp-wrap-creeping", "stamp-wrap-late"]


@pytest.mark.parametrize("case", WRAPPED)
def test_the_stamps_wrap_between_arming_and_edge(case: str) -> None:
    """Way of the approach, pause, way of the run; the start-up is between 0 and 0.2 s."""
    text = (PLANS / ROWS[case]["program"]).read_text(encoding="utf-8")
    pause_s = float(re.search(r"G04 (\S+)", text)[1])  # type: ignore[index]
    feed = float(re.search(r"G100 Z105 F(\d+)", text)[1]) / 60  # type: ignore[index]
    begin_mm = float(re.search(r"Z(\d+) F3000", text)[1])  # type: ignore[index]
    approach_s = (130 - begin_mm) / 50 + 50 / ACCELERATION
    surface = float(given(case, "plant:probe.surface_mm"))
    armed_s = START_MAX_S + approach_s + 1 / KV + 0.1 + pause_s
    edge_s = approach_s + pause_s + (begin_mm - surface) / feed
    assert armed_s < WRAP_S < edge_s
    assert ROWS[case]["rig"] == "rigs/probe-z-ethercat-stamps.toml"
    if case == "stamp-wrap":
        assert is_exact(case, "latch_error_um", -feed * DELAY_S * 1e3)
        return
    # As in test_measuring_edges.py: when a position loop is at rest, and when the edge comes
    contact_s = math.log(feed / KV / (surface - 105)) / KV
    rest_s = math.log(feed / KV / min(1e-4, INCREMENT_MM / (KV * T))) / KV
    left_s = contact_s + float(given(case, "plant:probe.trigger_delay_us")) * 1e-6 - rest_s
    assert abs(left_s) > 0.01
    assert (left_s < 0) is (case == "stamp-wrap-creeping")
    assert condition(case, "msg:N30") == ("== 1" if left_s < 0 else "== 0")
    if left_s < 0:
        low, high = limits(condition(case, "msg:N50"))
        assert 105 < low < 105 + (surface - 105) * math.exp(-KV * 0.04) < high < surface


def test_what_the_control_assumes_of_sampling_is_in_an_interpolated_value() -> None:
    """v times 250 us: 12.5 um at 50 mm/s; declared, or with the latch of the drive: nothing."""
    shift_s = rig_of(PLANS / "rigs" / "plc-timestamp-ethercat.toml")["segment"]["ec1"]["shift_us"]
    assumed = -float(given("sampling-assumed", "bus:ec1.assumed_sample_us"))
    assert assumed == shift_s
    v = speed("sampling-assumed")
    assert is_exact("sampling-assumed", "source_error_um", -v * assumed * 1e-3)
    assert is_exact("sampling-declared", "source_error_um", 0.0)
    assert given("sampling-drive", "bus:ec1.assumed_sample_us")
    assert not given("sampling-drive-declared", "bus:ec1.assumed_sample_us")


def phases(case: str) -> tuple[float, float, float]:
    """Frame, SYNC0 and sampling in their cycle, us."""
    row = ROWS[case]
    frame, sync = float(row["bus:ec1.frame_us"]), float(row["bus:ec1.shift_us"])
    return frame, sync, sync + float(given(case, "bus:ec1.sample_us") or 0)


DEAD = [case for case in ROWS if case.startswith("dead-")]


@pytest.mark.parametrize(
    "case", [*DEAD, "sampled-before-frame", "sampled-apart-old", "frame-after-sync0"]
)
def test_dead_cycles_by_the_phases(case: str) -> None:
    """Walked with a pencil: NC cycle at 600 us, frame, SYNC0, a period of interpolation, sample,
    frame, NC cycle. On CAN that is 2 cycles, of which optimized scheduling counts 1.
    """
    frame, sync, sample = phases(case)
    length = 12.0  # us that a frame needs, there and back

    def after(time: float, phase: float) -> float:
        return time + (phase - time) % 1000

    acts = after(after(600, frame) + length, sync)
    sampled = after(acts + 1000 * T * 1e-3 + 1e-6, sample)  # the first one behind the begin
    back = after(sampled - length, frame) + length
    cycles = -(-(back - 600) // 1000) + int(given(case, "drive:servo.second_delay_cycles") or 0)
    assert condition(case, "distance_dead_cycles") == f"== {cycles - 1:g}"
    assert condition(case, "distance_dead_cycles_expected") == f"== {cycles - 1:g}"


def test_nine_phases_of_frame_and_sync0() -> None:
    pairs = {(phases(case)[0], phases(case)[1]) for case in DEAD}
    assert pairs == {(frame, sync) for frame in (0, 300, 700) for sync in (100, 500, 900)}
    assert {condition(case, "distance_dead_cycles") for case in DEAD} == {"== 2"}


@pytest.mark.parametrize(("case", "dead"), [("kp-before", 1), ("kp-after", 2)])
def test_one_dead_cycle_more_lowers_the_limit_of_kp(case: str, dead: int) -> None:
    """z^(n+2) - z^(n+1) + kp (0.96 z + 0.04) = 0: 40 us of 1 ms are the age of the sample."""
    kp, share = (
        float(given(case, "set:Z.kenngr.distc.kp")),
        -float(given(case, "bus:ec1.sample_us")),
    )
    late = share / 1000
    size = dead + 2
    polynomial = [1.0, -1.0] + [0.0] * (size - 1)
    polynomial[size - 1] += kp * (1 - late)
    polynomial[size] += kp * late
    growth = max(abs(root) for root in roots(polynomial))
    low, high = limits(condition(case, "distance_growth"))
    assert (low + high) / 2 == pytest.approx(growth, abs=1e-5)
    assert condition(case, "distance_stability") == ("== stable" if growth < 1 else "== unstable")


def roots(polynomial: list[float]) -> list[complex]:
    """Durand-Kerner: of few degrees enough."""
    degree = len(polynomial) - 1
    found = [(0.4 + 0.9j) ** n for n in range(degree)]
    for _ in range(500):
        for n, z in enumerate(found):
            value = 0j
            for coefficient in polynomial:
                value = value * z + coefficient
            for m, other in enumerate(found):
                if m != n:
                    value /= z - other
            found[n] = z - value
    return found


def test_a_distance_that_is_not_taken_is_frozen_in_the_cycle_after_three() -> None:
    """As `id-900314-every` of distance_errors.csv: the sensor comes with each cycle there too."""
    can = rows_of("distance_errors")["id-900314-every"]["check:distance_alarm_after_cycles"]
    assert condition("counter-wrong-held", "distance_alarm_after_cycles") == can
    assert int(given("counter-wrong-held", "drive:servo.missing_cycles")) > MISSING + 1
    assert "count=3" in ROWS["counter-wrong-borne"]["inputs"]


def test_fixed_pdos_are_taken_or_refused() -> None:
    assert condition("pdos-refused", "alarms") == "== 900011"
    assert condition("pdos-fixed", "alarms") == "none"
    rig = rig_of(PLANS / "rigs" / "probe-z-ethercat-fixed.toml")["drive"]["servo"]
    text = (PLANS / "rigs" / rig["pdo_map"]).read_text(encoding="utf-8").splitlines()[1:]
    objects = [line.split(",")[3] for line in text]
    assert objects == ["0x6040", "0x607A", "0x60B8", "0x6041", "0x6064", "0x60B9", "0x60BA",
                       "0x60FD"]  # fmt: skip


LINE = rig_of(PLANS / "rigs" / "plc-timestamp-line.toml")
WIRE_S, SLAVE_S = 50e-9, 300e-9  # wire_ns and slave_ns, their defaults


def behind_um(case: str) -> float:
    """What all clocks are behind the master: the wire before the first slave is not in its time."""
    return speed(case) * WIRE_S * 1e3


@pytest.mark.parametrize(
    "case", ["terminal", "terminal-bounce-single", "terminal-delay-written", "terminal-drift-led"]
)
def test_a_stamp_of_the_line_is_the_edge_in_the_time_of_the_master(case: str) -> None:
    low, high = limits(condition(case, "latch_error_um"))
    assert (low + high) / 2 == pytest.approx(behind_um(case), abs=1e-6)
    width_um = INCREMENT_MM * 1e3
    if case == "terminal-drift-led":
        # Settled: 10 ns, and what the clock drifts between two frames
        ppm = float(given(case, "bus:ec1.drift_ppm").removeprefix("terminal="))
        assert given(case, "bus:ec1.clock_start_us") == "terminal=50"
        width_um += speed(case) * (10e-9 + ppm * 1e-6 * T) * 1e3
    assert (high - low) / 2 == pytest.approx(width_um, abs=1e-4)


def test_the_last_edge_of_a_bounce_is_so_much_later() -> None:
    single, continuous = "terminal-bounce-single", "terminal-bounce-continuous"
    fault = given(continuous, "fault:probe_chatter")
    assert fault == given(single, "fault:probe_chatter")
    period_us = float(re.search(r"pulses=1 period=(\d+)us", fault)[1])  # type: ignore[index]
    assert is_exact(
        continuous, "latch_error_um", behind_um(single) - speed(continuous) * period_us * 1e-3
    )
    assert given(continuous, "plc:terminal.stamp_edge") == "last"
    assert not given(single, "plc:terminal.stamp_edge")  # "first", the default: single event


def test_a_delay_that_is_not_written_is_v_times_it() -> None:
    case = "terminal-delay-missing"
    wire_s = float(given(case, "bus:ec1.wire_ns").removeprefix("terminal=")) * 1e-9
    assert wire_s + SLAVE_S == pytest.approx(10e-6)
    assert given(case, "bus:ec1.delay_compensation") == "false"
    late_um = speed(case) * (wire_s + SLAVE_S) * 1e3
    assert is_exact(case, "latch_error_um", behind_um(case) + late_um)


def test_a_clock_that_nobody_leads_is_ahead_by_its_drift_since_the_start() -> None:
    """The contact is 10 s after the offset was written, which is in the start-up."""
    case = "terminal-drift"
    v, ppm = speed(case), float(given(case, "bus:ec1.drift_ppm").removeprefix("terminal="))
    ways_s = (130 - APPROACH_MM) / 50 + 50 / ACCELERATION
    ways_s += (APPROACH_MM - SURFACE_MM) / v + v / (2 * ACCELERATION) + 1 / KV
    contact_s = float(given(case, "plc:V.E.PAUSE")) + ways_s
    # From there: what the axis needs to be at rest before the pause, and the start-up itself
    low, high = limits(condition(case, "latch_error_um"))
    assert high == pytest.approx(-v * ppm * 1e-6 * 10.0 * 1e3)
    assert contact_s == pytest.approx(10.0)
    assert low == pytest.approx(high - v * ppm * 1e-6 * 0.22 * 1e3)
    assert contact_s + START_MAX_S < 10.22
    assert given(case, "bus:ec1.drift_compensation") == "false"
