"""Limits of testplans/kinematics_measuring.csv from closed forms; nothing of the bench is imported.

A head with a lever of 180 mm. The path is a line of the tool with the share s of its way: from
(10, 20, 20) to (30, 5, -5) mm while C and A turn, 10 mm/s and 1 ms.
"""

import math
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path

import pytest
from tests.plans.shipped_files import limits, rig_of, rows_of

ROWS = rows_of("kinematics_measuring")
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
LEVER_MM, PERIOD_S, SPEED_MM_S = 180.0, 1e-3, 10.0
START, END = (10.0, 20.0, 20.0), (30.0, 5.0, -5.0)
LENGTH_MM = math.dist(START, END)
STEP = SPEED_MM_S * PERIOD_S / LENGTH_MM  # of the share, in a cycle
PRINTED = 1.6e-6  # six digits, and one in the last of them more
RESTS, MOVES = ("tool-z", "tool-a-strong"), ("tool-turns", "tool-a")  # A, with a stop at the tool
SIGNALS = {"msg:N50": 0, "msg:N60": 1, "msg:N70": 2, "msg:N80": "A", "msg:N90": "Z"}


def sin(degrees: float) -> float:
    return math.sin(math.radians(degrees))


def cos(degrees: float) -> float:
    return math.cos(math.radians(degrees))


def places(s: float) -> dict[str | int, float]:
    """Tool coordinates 0 to 2 and axes: the A axis is Rz(c) Rx(a) (0, 0, 180) from the tool."""
    tool = [a + (b - a) * s for a, b in zip(START, END, strict=True)]
    c, a = 20.0 + 40.0 * s, -35.0 + 25.0 * s
    return {
        **dict(enumerate(tool)),
        "X": tool[0] + LEVER_MM * sin(c) * sin(a),
        "Y": tool[1] - LEVER_MM * cos(c) * sin(a),
        "Z": tool[2] + LEVER_MM * cos(a),
        "C": c,
        "A": a,
    }


def body_share() -> float:
    """Where Z as an axis comes to 172 mm the first time; it rises until s = 0.66."""
    low, high = 0.0, 0.6
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if places(middle)["Z"] < 172.0 else (low, middle)
    return low


@pytest.mark.parametrize(
    ("case", "share", "cycles"),
    [
        ("path-offset", 1.0 - 14.14 / LENGTH_MM, 1),
        ("share", 0.6, 1),
        ("positions", 0.5, 2),  # P-AXIS-00145 is rounded to 0.1 um
        ("body", body_share(), 1),
    ],
)
def test_a_simulated_signal_is_of_the_cycle_in_which_its_condition_holds(
    case: str, share: float, cycles: int
) -> None:
    before, after = places(share), places(share + cycles * STEP)
    for metric, what in SIGNALS.items():
        expected = sorted((before[what], after[what]))
        expected = [expected[0] - 1e-6, expected[1] + 1e-6]
        assert limits(ROWS[case][f"check:{metric}"]) == pytest.approx(expected, abs=PRINTED)


def test_the_axes_are_half_way_where_their_parameters_have_them() -> None:
    """X goes the other way first: it comes to this place once, from below."""
    half = places(0.5)
    for axis in "XYZCA":
        written = float(ROWS["positions"][f"set:{axis}.meas_simu.parameter1"])
        assert written == pytest.approx(half[axis] * 1e4, abs=0.5)
    x = [places(at / 1000.0)["X"] for at in range(1001)]
    assert x[1] < x[0] < half["X"]
    assert [a < half["X"] <= b for a, b in pairwise(x)].count(True) == 1
    assert min(places(at / 100.0)["Y"] for at in range(101)) > -10.0  # row one-never


# So many cycles after the motion has begun (mode 2): v t - v²/2a with the acceleration of the path

AXIS_MM_S2 = 1000.0  # of each axis, in degrees where it turns
PLACES = 2000


def ramp_loss(course: Callable[[float], dict[str | int, float]], length: float, v: float) -> float:
    """v²/2a with the largest q' and q'' of the whole block.

    q'' u² takes half of what an axis may do at the highest speed u, and a run keeps that free: a is
    the least of (1000 - q'' u²)/q'.
    """
    step = length / PLACES
    rows = [course(at / PLACES) for at in range(PLACES + 1)]
    slopes, bends = [], []
    for axis in "XYZCA":
        q = [row[axis] for row in rows]
        slopes.append(max(abs(b - a) for a, b in pairwise(q)) / step)
        changes = (abs(a - 2.0 * b + c) for a, b, c in zip(q, q[1:], q[2:], strict=False))
        bends.append(max(changes) / step**2)
    highest2 = AXIS_MM_S2 / 2.0 / max(bends)
    ramps = [
        (AXIS_MM_S2 - bend * highest2) / slope
        for slope, bend in zip(slopes, bends, strict=True)
        if slope > 0.0
    ]
    return v * v / (2.0 * min(ramps))


def tool(axes: Mapping[str | int, float]) -> dict[str, float]:
    """Tool coordinates of positions of the axes, by the metrics of the rows."""
    lean, turned = axes["A"], axes["C"]
    return {
        "msg:N50": axes["X"] - LEVER_MM * sin(turned) * sin(lean),
        "msg:N60": axes["Y"] + LEVER_MM * cos(turned) * sin(lean),
        "msg:N70": axes["Z"] - LEVER_MM * cos(lean),
        "msg:N80": lean,
        "msg:N90": axes["Z"],
    }


def counted(case: str, axis: str, v: float, loss: float) -> list[float]:
    """How far the path has come when the cycles of an axis are over, one before, one after."""
    cycles = float(ROWS[case][f"set:{axis}.meas_simu.parameter1"])
    return [(cycles + more) * v * PERIOD_S - loss for more in (-1, 0, 1)]


def test_a_count_of_cycles_is_of_the_motion() -> None:
    loss = ramp_loss(places, LENGTH_MM, SPEED_MM_S)
    found = [tool(places(at / LENGTH_MM)) for at in counted("cycles", "A", SPEED_MM_S, loss)]
    for metric in SIGNALS:
        ends = sorted((found[0][metric], found[-1][metric]))
        assert limits(ROWS["cycles"][f"check:{metric}"]) == pytest.approx(ends, abs=PRINTED)


def about_the_tool(share: float) -> dict[str | int, float]:
    """A from -35 to -10 with the tool at (10, 20, 20), C 20."""
    a = -35.0 + 25.0 * share
    return {
        "X": 10.0 + LEVER_MM * sin(20.0) * sin(a),
        "Y": 20.0 - LEVER_MM * cos(20.0) * sin(a),
        "Z": 20.0 + LEVER_MM * cos(a),
        "C": 20.0,
        "A": a,
    }


def test_type_2_has_the_speed_of_the_axis_that_is_named() -> None:
    """A alone: 5 degrees/s of its list, not the 10 of the block nor the 8 of Z."""
    row = ROWS["type-2-turn"]
    v = float(row["set:A.kenngr.vb_messen"]) * 1e-3
    assert v != float(row["set:Z.kenngr.vb_messen"]) * 1e-3 != float(row["plc:V.E.FEED"]) / 60.0
    loss = ramp_loss(about_the_tool, 25.0, v)
    found = [tool(about_the_tool(at / 25.0)) for at in counted("type-2-turn", "A", v, loss)]
    for metric in ("msg:N80", "msg:N90"):
        ends = sorted((found[0][metric], found[-1][metric]))
        assert limits(row[f"check:{metric}"]) == pytest.approx(ends, abs=PRINTED)
    for metric, at in (("msg:N50", 10.0), ("msg:N60", 20.0), ("msg:N70", 20.0)):
        assert limits(row[f"check:{metric}"]) == pytest.approx((at, at), abs=2.0 * PRINTED)


def test_type_2_touches_past_its_target_with_the_speed_of_z() -> None:
    """The surface is at 0, the target 1 mm above it, P-AXIS-00467 of Z 5 mm; then F acts."""
    row = ROWS["type-2"]
    half_mm = 0.5e-5 + LEVER_MM * math.radians(0.5e-4)
    for metric, at in (("msg:N50", 10.0), ("msg:N60", 20.0)):
        assert limits(row[f"check:{metric}"]) == pytest.approx(
            (at - 2 * half_mm, at + 2 * half_mm), abs=1e-5
        )
    assert float(row["plc:V.E.Z"]) - float(row["set:Z.kenngr.probing_offset"]) * 1e-4 < 0.0
    assert limits(row["check:msg:N70"]) == pytest.approx((0.0, 0.0), abs=5.1e-6)
    at_z = LEVER_MM * cos(35.0)
    assert limits(row["check:msg:N90"]) == pytest.approx((at_z - 5e-6, at_z + 5e-6), abs=1e-6)
    step_mm_s = 1e-5 / PERIOD_S  # an increment in a cycle
    v = float(row["set:Z.kenngr.vb_messen"]) * 1e-3
    assert limits(row["check:contact_velocity_mm_s:Z"]) == pytest.approx(
        (-v - step_mm_s, -v + step_mm_s)
    )
    f = float(row["plc:V.E.FEED"]) / 60.0
    assert limits(row["check:tcp_velocity_mm_s_max"]) == pytest.approx(
        (f - step_mm_s, f + step_mm_s)
    )


@pytest.mark.parametrize("case", ["target", "first"])
def test_at_the_target_means_there(case: str) -> None:
    end = places(1.0)
    for metric, what in SIGNALS.items():
        low, high = limits(ROWS[case][f"check:{metric}"])
        assert (low + high) / 2.0 == pytest.approx(end[what], abs=PRINTED)
        assert high - low <= 4.1e-6


def test_what_is_at_its_target_already_signals_in_the_first_cycle() -> None:
    for metric, begin, way in (("msg:N70", 20.0, -25.0), ("msg:N80", -35.0, 25.0)):
        ends = sorted((begin, begin + way * STEP))
        low, high = limits(ROWS["first-at-once"][f"check:{metric}"])
        assert (low, high) == pytest.approx(ends, abs=PRINTED)


def test_one_simulated_axis_beside_real_latches_is_off_by_its_cycle() -> None:
    """From (10, 20) to (30, -5) A turns 25 degrees in 32.016 mm; Z0 is met at 4/5 of it, at -15."""
    step_deg = 25.0 / math.hypot(20.0, 25.0) * SPEED_MM_S * PERIOD_S
    low, high = limits(ROWS["one"]["check:msg:N60"])
    assert (low, high) == pytest.approx((-15.0, -15.0 + step_deg), abs=PRINTED)
    low, high = limits(ROWS["one"]["check:msg:N50"])
    late_mm = LEVER_MM * (cos(15.0 - step_deg) - cos(15.0))
    assert high == -low == pytest.approx(late_mm + 3e-4, abs=PRINTED)  # 1e-4 degrees, 180 mm


# Fixed stops

KV, LIMIT_MM, TAU_S, AGE_MS = 40.0, 1.5, 0.1, 0.552
FORCE_MM = 500.388 / 20e3  # 362 per mille of the motor, 20 N/um: as in fixed_stop_timing.csv
TORQUE_DEG = 0.013689  # 47.784 N.m on 2e5 N.m/rad: as in fixed_stop_rotary.csv


def assert_found(case: str, axis: str, after_s: float) -> None:
    band = limits(ROWS[case][f"check:contact_to_detection_ms:{axis}"])
    expected = (after_s * 1e3 + AGE_MS, after_s * 1e3 + AGE_MS + 1.0)
    assert band == pytest.approx(expected, abs=1e-4)


def test_an_axis_of_the_kinematic_is_found_by_its_lag_as_any_other() -> None:
    for case, axis, deep in (("stop-z", "Z", FORCE_MM), ("stop-a", "A", TORQUE_DEG)):
        assert_found(case, axis, (LIMIT_MM - SPEED_MM_S / KV + deep) / SPEED_MM_S + TAU_S)
    row = ROWS["stop-z"]
    assert limits(row["check:latch_mm:Z"]) == pytest.approx((149.97398, 149.97598), abs=1e-5)
    tool_mm = 150.0 - FORCE_MM - LEVER_MM * cos(35.0)
    assert limits(row["check:msg:N180"]) == pytest.approx(
        (tool_mm - 1e-3, tool_mm + 1e-3), abs=1e-6
    )


def test_the_tool_is_where_the_axes_are_that_went_on() -> None:
    """A is held at -20.0137 degrees. Y goes with the demand of A, 0.25 degrees ahead at the
    contact, to one cycle of the exchange; Z is v/Kv of the demand behind."""
    row, held = ROWS["stop-a"], 20.0 + TORQUE_DEG
    found_s = (LIMIT_MM - SPEED_MM_S / KV + TORQUE_DEG) / SPEED_MM_S + TAU_S
    at_deg = [20.25 + SPEED_MM_S * (found_s + late * 1e-3) for late in (0.0, 1.0)]
    y = [20.0 + LEVER_MM * cos(20.0) * (sin(deg) - sin(held)) for deg in at_deg]
    z = [20.0 + LEVER_MM * (cos(deg - 0.25) - cos(held)) for deg in at_deg]
    for metric, ends, more in (("msg:N170", y, 1e-3), ("msg:N180", z, 6e-3)):
        low, high = limits(row[f"check:{metric}"])
        assert min(ends) - more < low < min(ends)
        assert max(ends) < high < max(ends) + more
    # of Z: its acceleration 180 cos(22) (10 deg/s)^2 over Kv^2
    assert LEVER_MM * math.radians(10.0) ** 2 / KV**2 < 5e-3


def test_a_window_holds_at_a_stop_on_a_line_of_the_tool() -> None:
    """A has 25 degrees of the 35.36 mm."""
    speed_deg_s = 25.0 / LENGTH_MM * SPEED_MM_S
    assert_found("stop-a-window", "A", TAU_S - (0.02 - TORQUE_DEG) / speed_deg_s)
    assert ROWS["stop-a-window"]["check:detection_followed_error_ms"] == "== 0"


def test_an_axis_that_turns_round_is_at_rest_for_its_window() -> None:
    """z' = 0 where sin(a) = 1/(180 rad/deg), z'' = -180 cos(a) (a' rad/s)^2: the way of the last
    100 ms is below 2 um from 7.7 ms before the middle on, with the turn 42.3 ms behind."""
    turn_deg = math.degrees(math.asin(25.0 / (LEVER_MM * math.radians(25.0))))
    share = (35.0 - turn_deg) / 25.0
    bend = LEVER_MM * cos(turn_deg) * (math.radians(25.0) * SPEED_MM_S / LENGTH_MM) ** 2
    steps = [
        math.dist(*([places(s + d)[a] for a in "XYZCA"] for d in (0.0, STEP)))
        for s in (share, share + 0.05)
    ]
    assert steps[1] < steps[0]  # and yet the tool does not slow down
    since_s = TAU_S / 2.0 - 0.002 / (bend * TAU_S)
    low, high = limits(ROWS["stop-z-turns"]["check:latch_mm:Z"])
    expected = places(share)["Z"] - bend * since_s**2 / 2.0
    assert (low + high) / 2.0 == pytest.approx(expected, abs=1e-5)
    assert high - low == pytest.approx(2e-3)
    assert ROWS["stop-z-turns"]["check:found_without_contact"] == "== 1"


# A stop at the tool: level, at the height 0; Z and A share its force F as F and F L sin a

STIFF_N_MM, FORCE_N, TORQUE_N_MM = 20e3, 500.388, 47.784e3  # 362 per mille of each motor
TRAVEL_MM, ABOVE_MM = 25.0, 20.0  # from 20 mm above the stop to 5 mm below
A_GAIN_NM_S = 2.0 * math.pi * 60.0 * (0.5 + 1.8e-4 * 60.0**2)  # of the velocity loop of A
A_INTEGRAL_S = 8e-3
DOUBT_MS = 0.1  # what second differences of the lags leave: below 1 um at 10 mm/s


FOUND_S = (LIMIT_MM - SPEED_MM_S / KV + FORCE_MM) / SPEED_MM_S + TAU_S


def tool_row(case: str) -> tuple[dict[str, str], float, float]:
    """A row, with A in degrees where its path begins, and per mm of it."""
    row = ROWS[case]
    begin, end = float(row["plc:V.E.A"]), float(row["plc:V.E.A_END"])
    assert (row["plant:z.stop_position_mm"], row["plc:V.E.FEED"]) == ("0", "600")
    return row, begin, (end - begin) / TRAVEL_MM


def torque_limit(row: dict[str, str]) -> float:
    return TORQUE_N_MM * float(row["plc:V.E.LIMIT_A"]) / 362.0


def assert_tool_found(case: str, after_s: float, doubt_ms: float = 0.0) -> None:
    low, high = limits(ROWS[case]["check:contact_to_detection_ms:Z"])
    assert low == pytest.approx(after_s * 1e3 + AGE_MS - doubt_ms, abs=1e-4)
    assert high == pytest.approx(after_s * 1e3 + AGE_MS + 1.0 + doubt_ms, abs=1e-4)
    assert ROWS[case]["check:detection_followed_error_ms"] == "== 0"
    assert ROWS[case]["check:msg:N160"] == "== 1"


def push_away(case: str, after_s: float) -> float:
    """Degrees that A is off its demand: a torque that comes at once takes it M Tn/K away, and the
    position loop brings it back with 1/Kv. M at most that of F + sqrt(F² + k m v²)."""
    row, begin, rate = tool_row(case)
    assert rate == 0.0
    mass = 120.0 + 1.8e-4 * (2.0 * math.pi / 0.01) ** 2
    impact = math.sqrt(STIFF_N_MM * 1e3 * mass) * SPEED_MM_S * 1e-3
    peak = (FORCE_N + math.hypot(FORCE_N, impact)) * LEVER_MM * abs(sin(begin))
    assert peak < torque_limit(row)
    return math.degrees(peak * 1e-3 * A_INTEGRAL_S / A_GAIN_NM_S) * math.exp(-KV * after_s)


@pytest.mark.parametrize("case", RESTS)
def test_a_stop_at_the_tool_takes_the_force_of_z_where_a_holds(case: str) -> None:
    """A gets F L sin a, always less than its limit, and stays."""
    row, begin, _ = tool_row(case)
    torque = FORCE_N * LEVER_MM * abs(sin(begin))
    assert_tool_found(case, FOUND_S)
    assert limits(row["check:msg:N180"]) == pytest.approx((-FORCE_MM - 1e-3, -FORCE_MM + 1e-3))
    force, moment = (limits(row[f"check:stop_{what}"]) for what in ("force_n:Z", "torque_nm:A"))
    assert sum(force) / 2.0 == pytest.approx(FORCE_N, abs=1e-3)
    assert sum(moment) / 2.0 == pytest.approx(torque * 1e-3, abs=1e-3)
    low, high = limits(row["check:msg:N190"])
    assert (low + high) / 2.0 == pytest.approx(begin, abs=1e-9)
    assert (high - low) / 2.0 == pytest.approx(push_away(case, FOUND_S) + 2.9e-6, abs=1e-7)


def test_a_tool_that_turns_presses_with_z_all_the_same() -> None:
    """Set less actual height of the tool: what Z is behind, and what the lag of A lifts it."""
    row, begin, rate = tool_row("tool-turns")
    most = FORCE_N * LEVER_MM * abs(sin(begin))
    assert most < torque_limit(row)
    turn = math.radians(rate) * SPEED_MM_S / KV  # A is behind

    def missing(after_mm: float) -> float:
        lean = begin + rate * (ABOVE_MM + SPEED_MM_S / KV + after_mm)
        lifted = LEVER_MM * abs(sin(lean)) * turn
        return after_mm - (LIMIT_MM - SPEED_MM_S / KV + FORCE_MM + lifted)

    assert_tool_found("tool-turns", root(missing, 0.0, 5.0) / SPEED_MM_S + TAU_S, DOUBT_MS)
    assert limits(row["check:msg:N180"]) == pytest.approx((-FORCE_MM - 1e-3, -FORCE_MM + 1e-3))


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a function that rises is 0."""
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if function(middle) < 0.0 else (low, middle)
    return low


def test_where_the_torque_of_a_is_the_weaker_one_a_gives_way() -> None:
    """Z goes on with its demand, so that the lever says where A is: L (cos a - cos a_d) = h_d + p
    - z_d'/Kv. The force is M/(L sin a), so the place is not where Z would stop."""
    row, begin, rate = tool_row("tool-a")
    torque = torque_limit(row)
    assert torque < FORCE_N * LEVER_MM * abs(sin(begin))

    def deep(lean: float) -> float:
        return torque / (LEVER_MM * abs(sin(lean))) / STIFF_N_MM

    def pushed(after_mm: float) -> tuple[float, float]:
        """Demand of A and A after so much of the way of the tool since the contact."""
        way = ABOVE_MM + SPEED_MM_S / KV + after_mm
        asked = begin + rate * way
        slope = -SPEED_MM_S + LEVER_MM * abs(sin(asked)) * math.radians(rate) * SPEED_MM_S

        def missing(lean: float) -> float:
            height = ABOVE_MM - way + deep(lean) - slope / KV
            return LEVER_MM * (cos(lean) - cos(asked)) - height

        return asked, root(missing, -60.0, asked)

    def beyond(after_mm: float) -> float:
        asked, lean = pushed(after_mm)
        return asked - lean - LIMIT_MM

    after_s = root(beyond, 0.5, 20.0) / SPEED_MM_S + TAU_S
    assert_tool_found("tool-a", after_s, DOUBT_MS)
    found = [pushed((after_s + late * 1e-3) * SPEED_MM_S)[1] for late in (2.0, 0.0)]
    doubt = SPEED_MM_S * DOUBT_MS * 1e-3 / (LEVER_MM * abs(sin(found[0])))
    ends = found[0] - math.degrees(doubt), found[1] + math.degrees(doubt)
    assert limits(row["check:latch_deg:A"]) == pytest.approx(ends, abs=1e-5)
    low, high = limits(row["check:msg:N180"])
    assert (low + high) / 2.0 == pytest.approx(-sum(map(deep, found)) / 2.0, abs=1e-6)
    assert high - low == pytest.approx(2e-3)
    assert low > -FORCE_MM  # not as deep as Z would press


def test_an_axis_that_rests_on_the_path_is_no_stop() -> None:
    row, begin, rate = tool_row("tool-a-rests")
    assert rate == 0.0
    assert torque_limit(row) < FORCE_N * LEVER_MM * abs(sin(begin))


def test_the_axes_come_back_to_half_an_increment() -> None:
    drives = rig_of(RIGS / "fixed-stop-5axis.toml")["drive"]
    assert rig_of(RIGS / "fixed-stop-tool.toml")["drive"] == drives
    half = {name: of["lead_mm"] / of["encoder_increments"] / 2.0 for name, of in drives.items()}
    away_mm = half["servo"] + 2.0 * LEVER_MM * math.radians(half["worm"])
    for case in ("stop-z", "stop-a", "stop-a-window", "stop-z-turns", *RESTS, *MOVES):
        # An axis that rests on the path is not led: it stays at its demand
        off_deg = push_away(case, FOUND_S) if case in RESTS else 0.0
        for metric in ("msg:N200", "msg:N210"):
            low, high = limits(ROWS[case][f"check:{metric}"])
            most_mm = away_mm + LEVER_MM * math.radians(off_deg)
            assert high == -low == pytest.approx(most_mm, abs=1e-7)


def test_what_is_refused_or_missing_has_its_alarm() -> None:
    alarms = {name: row["check:alarms"] for name, row in ROWS.items() if "bad" in row["tags"]}
    assert alarms == {
        "cycles-apart": "== 900003",
        "one-never": "== 900003",
        "none": "== 900004",
        "other-value": "== 110508 900640 50059",
        "tool-a-rests": "== 900240",
        "type-2-none": "== 900004",
        "type-2-axes": "== 50061",
        "stop-missing": "== 900240",
        "stop-source": "== 900241",
        "stop-not-released": "== 50059",
        "stop-too-long": "== 110757 51026",
    }
