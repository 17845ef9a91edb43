"""Limits of the shipped plan of signal sources, recomputed from closed forms written out here.

Nothing of the bench is imported: rigs and plan are read as the text files they are.
"""

import math
import re

import pytest
from tests.plans.shipped_files import PLANS, rig_of, rows_of

INCREMENT_UM = 10_000 / 2**20
SYNC_US = 48  # 44 bits and 4 stuff bits at 1 Mbit/s
BASE = {"period_us": 2000, "offset_us": 300, "busy_us": 0}


ROWS = rows_of("plc_sources")


def _source(row: dict[str, str]) -> str:
    """The column, else what the list of the rig says."""
    if row["set:Z.kenngr.measure.signal"]:
        return row["set:Z.kenngr.measure.signal"]
    rig_file = PLANS / row["rig"]
    text = (rig_file.parent / rig_of(rig_file)["axis"]["Z"]["list"]).read_text(encoding="utf-8")
    if re.search(r"^kenngr.probing_signal_via_plc\s+1", text, re.M):
        return "PLC"
    found = re.search(r"^kenngr.measure.signal\s+(\w+)", text, re.M)
    assert found is not None
    return found[1]


def _delays_us(row: dict[str, str]) -> tuple[float, float]:
    """The least and the most from contact to the SYNC whose position counts.

    filter + [0, T_x) + [0, T_plc) + busy, then the first NC cycle after it, back to its SYNC. Where
    the terminal is exchanged with the task, and where its cycle is whole cycles of the task, its
    wait and that of the task are one.
    """
    rig = rig_of(PLANS / row["rig"])
    plc, cnc = rig["plc"], rig["cycle"]
    period = float(row["plc:period_us"] or plc["period_us"])
    offset, busy = plc["offset_us"], float(row["plc:busy_us"] or 0)
    age = cnc["cycle_offset_us"] - SYNC_US
    every = period * max(1, math.ceil(busy / period))
    filter_us = float(row["plc:terminal.filter_us"] or 0)
    exchange = float(row["plc:terminal.cycle_us"] or period)
    wait_after = (offset - float(row["plc:terminal.offset_us"] or offset)) % period
    written = offset + busy
    hand_over = (cnc["cycle_offset_us"] - written) % cnc["period_us"] or cnc["period_us"]
    assert period % cnc["period_us"] == 0, "a task that slides has no such band"
    least = filter_us + wait_after + busy + hand_over - age
    if exchange == period and every > period:
        return least, least + every  # the exchange is on time, the task late
    return least, least + exchange


AT_SIGNAL = ("PLC", "PLC_FIRST_EVENT", "PLC_EXT_LATCH_CONTROL")
BANDS = [
    name
    for name, row in ROWS.items()
    if row["check:latch_error_um"] and _source(row) in AT_SIGNAL
    if not row["plc:V.E.POSITION"] and "terminal" in rig_of(PLANS / row["rig"])["plc"]
]


@pytest.mark.parametrize("case", BANDS)
def test_the_band_of_a_signal_at_the_plc_is_its_chain(case: str) -> None:
    """Down at v: the value of a late position is lower, of an early one higher."""
    row = ROWS[case]
    least_us, most_us = _delays_us(row)
    v_um_us = float(row["plc:V.E.FEED"]) / 60 / 1000
    low, high = (float(text) for text in row["check:latch_error_um"].split(" .. "))
    assert low == pytest.approx(-v_um_us * most_us - INCREMENT_UM, abs=1e-4)
    assert high == pytest.approx(-v_um_us * least_us + INCREMENT_UM, abs=1e-4)


def test_the_band_of_a_digital_input_of_the_drive() -> None:
    """4 us, U to the SYNC, the NC cycle, the next PLC cycle after it, the next NC cycle, its SYNC.

    NC cycles at 0.6 and 1.6 of 2 ms, PLC at 0.3: 1.7 or 0.7 ms from one to the other, then 0.3 ms.
    """
    row = ROWS["plc-drive-input"]
    rig = rig_of(PLANS / row["rig"])
    assert (rig["plc"]["period_us"], rig["plc"]["offset_us"]) == (2000, 300)
    assert (rig["cycle"]["period_us"], rig["cycle"]["cycle_offset_us"]) == (1000, 600)
    age = 600 - SYNC_US
    delay = rig["drive"]["servo"]["input_delay_us"] + age + 300 - age
    least, most = delay + 700, delay + 1000 + 1700
    low, high = (float(text) for text in row["check:latch_error_um"].split(" .. "))
    assert low == pytest.approx(-most / 100 - INCREMENT_UM, abs=1e-4)
    assert high == pytest.approx(-least / 100 + INCREMENT_UM, abs=1e-4)


def test_a_position_that_the_plc_hands_over_is_the_value() -> None:
    """Without one the actual value: N20 begins at 110.374; 5 cycles until the path and its age."""
    for case in ("plc-position", "first-event-position"):
        handed_mm = ROWS[case]["plc:Z.probing_position"].split(" at=")[0]
        assert ROWS[case]["check:latch_mm"] == f"{handed_mm} +- 0.00000001"
    v, a, kv, start_mm = 10.0, 1000.0, 40.0, 110.374
    lost_mm = v * v / (2 * a) + v / kv
    low, high = (float(text) for text in ROWS["plc-no-position"]["check:latch_mm"].split(" .. "))
    assert low == pytest.approx(start_mm - v * 0.500 + lost_mm, abs=2e-5)
    assert high == pytest.approx(start_mm - v * 0.495 + lost_mm, abs=2e-5)


def test_there_are_such_rows() -> None:
    assert len(BANDS) >= 10


def test_the_spread_of_locked_and_sliding_tasks() -> None:
    """v T/sqrt(12), v sqrt(T_plc^2 + T_cnc^2)/sqrt(12), within twice its bound by chi-square."""
    judged = 0
    for name, row in ROWS.items():
        if "+-" not in row["check:spread(latch_error_um)"]:
            continue
        judged += 1
        v, period = float(row["plc:V.E.FEED"]) / 60, float(row["plc:period_us"]) / 1000
        square = period**2 + (1.0 if name == "plc-sliding" else 0.0)
        expected = v * math.sqrt(square / 12)
        middle, width = (float(part) for part in row["check:spread(latch_error_um)"].split(" +- "))
        assert middle == pytest.approx(expected, abs=5e-4)
        assert width == pytest.approx(0.6 * expected, abs=1e-3)
        touches, shift = float(row["plc:V.E.TOUCHES"]), float(row["plc:V.E.SHIFT"])
        assert shift * touches == pytest.approx(v * 1e-3)  # phases over a cycle of the CNC
    assert judged == 4


STATISTIC = [name for name, row in ROWS.items() if "statistics" in row["tags"]]


@pytest.mark.parametrize("case", STATISTIC)
def test_every_touch_is_its_closed_form_to_an_increment(case: str) -> None:
    row = ROWS[case]
    assert row["check:mean(source_error_um)"] == "0.000 +- 0.0095"
    assert row["check:range(source_error_um)"] == "<= 0.0191"
    assert row["check:count(source_error_um)"] == f"== {row['plc:V.E.TOUCHES']}"
    assert math.isclose(0.0095, INCREMENT_UM, rel_tol=5e-3)


def test_what_a_stamp_is_off_by() -> None:
    """v times filter, clock, resolution, jitter, bounce; down, so a late stamp reads low."""
    v = {name: float(row["plc:V.E.FEED"] or 600) / 60 for name, row in ROWS.items()}  # um/ms
    expected = {
        "stamp-f1000": (-v["stamp-f1000"] * 0.005, 0.0),
        "stamp-clock-behind": (v["stamp-clock-behind"] * 1.0, 0.0),
        "stamp-clock-known": (0.0, 0.0),
        "stamp-drift-known": (0.0, 0.0),
        "stamp-late": (0.0, 0.0),
        "stamp-first-edge": (0.0, 0.0),
        "stamp-last-edge": (-v["stamp-last-edge"] * 2.0, 0.0),
        "stamp-resolution": (0.0, v["stamp-resolution"] * 0.1),
        "stamp-jitter": (-v["stamp-jitter"] * 0.05, v["stamp-jitter"] * 0.05),
    }
    for name, (low_um, band_um) in expected.items():
        text = ROWS[name]["check:latch_error_um"]
        if "+-" in text:
            middle, width = (float(part) for part in text.split(" +- "))
            low, high = middle - width, middle + width
        else:
            low, high = (float(part) for part in text.split(" .. "))
        assert low == pytest.approx(low_um - INCREMENT_UM, abs=2e-4), name
        assert high == pytest.approx(low_um + band_um + INCREMENT_UM, abs=2e-4), name


def test_a_drift_counts_from_the_start() -> None:
    """v times 100 ppm of the instant of the edge, which follows from the program.

    N10 is 19.626 mm at 50 mm/s; its lag of a/kv² (1 - exp(-kv v/a)) decays into the window of
    0.1 um. N20 is 10.374 mm at 10 mm/s, with half a ramp and the lag of the loop. The start of the
    drives and the cycles between the blocks take 0 to 50 ms more.
    """
    a, kv, window_mm = 800.0, 40.0, 1e-4
    lag_mm = a / kv**2 * (1 - math.exp(-kv * 50.0 / a))
    n10_s = 19.626 / 50.0 + 50.0 / a + math.log(lag_mm / window_mm) / kv
    edge_s = n10_s + 10.374 / 10.0 + 10.0 / (2 * a) + 1 / kv
    um_per_s = 10.0 * 1000 * 100e-6
    low, high = (float(t) for t in ROWS["stamp-drift"]["check:latch_error_um"].split(" .. "))
    assert low == pytest.approx(um_per_s * edge_s - INCREMENT_UM, abs=2e-4)
    assert high == pytest.approx(um_per_s * (edge_s + 0.05) + INCREMENT_UM, abs=2e-4)


def test_radio_probes_have_the_delay_of_the_drive_and_of_the_radio() -> None:
    assert ROWS["radio-f600"]["check:latch_error_um"] == "-0.0400 +- 0.0095"  # 4 us at 10 mm/s
    assert ROWS["radio-delay"]["check:latch_error_um"] == "-100.0400 +- 0.0095"  # and 10 ms


# What each source has to survive, and the alarm that is documented; "" a value inside its band
BAD = {
    "plc": {
        "actuated": "== 50052",
        "bounce": "",
        "overrun": "",
        "overrun-watched": "== 900402",
        "task-stopped": "== 900402",
        "terminal-lost": "== 900401",
        "pdo-lost": "== 900006",
    },
    "stamp": {
        "actuated": "== 50052",
        "bounce": "",
        "overrun": "",
        "task-stopped": "== 900402",
        "terminal-lost": "== 900401",
        "pdo-lost": "== 900006",
        "future": "== 900403",
        "too-old": "== 900404",
        "of-run-before": "== 900405",
    },
    "ext": {
        "bounce": "",
        "overrun": "",
        "overrun-watched": "== 900402",
        "reset": "",
        "enable-missing": "== 50050",
        "disable-missing": "== 900406",
        "task-stopped": "== 900402",
        "terminal-lost": "== 900401",
        "pdo-lost": "== 900006",
    },
    "radio": {
        "actuated": "== 50052",
        "bounce": "",
        "overrun": "== 900402",
        "prepare-missing": "== 50050",
        "enable-missing": "== 50050",
        "disable-missing": "== 900406",
        "task-stopped": "== 900402",
        "pdo-lost": "== 900006",
    },
    "drive": {"bounce": ""},
}
BAD["first-event"] = BAD["plc"]


@pytest.mark.parametrize("source", BAD)
def test_each_source_has_its_bad_situations(source: str) -> None:
    for situation, alarm in BAD[source].items():
        row = ROWS[f"{source}-{situation}"]
        assert "bad" in row["tags"].split()
        assert row["check:alarms"] == (alarm or "none")
        assert bool(row["check:latch_error_um"]) is (alarm == "")
    of_source = [row for name, row in ROWS.items() if name.startswith(f"{source}-")]
    for row in of_source:
        if "alarm" in row["tags"].split():
            assert row["check:latch_error_um"] == "", row["case"]


WITH_BOUNCE = ["plc-bounce", "first-event-bounce", "stamp-bounce", "ext-bounce", "drive-bounce"]


@pytest.mark.parametrize("case", WITH_BOUNCE)
def test_the_second_trigger_comes_while_the_axis_brakes(case: str) -> None:
    """Two openings: edges at 0, 1/2 and 1 of the time; v/a of set position and 1/Kv of lag."""
    row = ROWS[case]
    probe = rig_of(PLANS / row["rig"])["plant"]["probe"]["start"]
    count = float(row["plant:probe.bounce_count"] or probe["bounce_count"])
    second_s = float(row["plant:probe.bounce_time_ms"]) / 1000 / count
    assert count == 2
    assert second_s < float(row["plc:V.E.FEED"]) / 60 / 1000.0 + 1 / 40.0
