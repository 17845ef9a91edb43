"""Every limit of testplans/measuring_types.csv, recomputed from closed forms written out here.

Nothing of the bench is imported: rig, list, programs and plan are read as the text files they are.
Lengths in mm, times in s.
"""

import csv
import re
import tomllib
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"
RIG = PLANS / "rigs" / "probe-z.toml"
SYNC_US = 48  # test_shipped_bands.py recomputes it

with (PLANS / "measuring_types.csv").open(encoding="utf-8", newline="") as _file:
    ROWS = {row["case"]: row for row in csv.DictReader(_file)}

RIG_DATA = tomllib.loads(RIG.read_text(encoding="utf-8"))
T = RIG_DATA["cycle"]["period_us"] * Decimal("1e-6")
OFFSET = RIG_DATA["cycle"]["cycle_offset_us"] * Decimal("1e-6")
INPUT_DELAY = Decimal(str(RIG_DATA["drive"]["servo"]["input_delay_us"])) * Decimal("1e-6")
KV = Decimal(RIG_DATA["plant"]["z"]["start"]["kv"])
SURFACE = Decimal(RIG_DATA["plant"]["probe"]["start"]["surface_mm"])
INCREMENT = (
    Decimal(str(RIG_DATA["drive"]["servo"]["lead_mm"]))
    / RIG_DATA["drive"]["servo"]["encoder_increments"]
)


def _listed(name: str) -> Decimal:
    path = RIG.parent / RIG_DATA["axis"]["Z"]["list"]
    match = re.search(rf"^{re.escape(name)}\s+(\d+)", path.read_text(encoding="utf-8"), re.M)
    assert match is not None, name
    return Decimal(match[1])


A = _listed("getriebe[0].lslope_profil.a_grenz_stufe_1")
assert _listed("getriebe[0].lslope_profil.a_grenz_stufe_2") == A, "one slope: no change-over"
A_FEEDHOLD = _listed("getriebe[0].lslope_profil.a_feedh")
# What the lists leave unset: FCT-C4 8.2.2
UNSET = {
    "set:Z.kenngr.vb_messen": 16666,
    "set:Z.kenngr.hub_messtaster": 50000,
    "set:Z.kenngr.probing_offset": 0,
    "set:Z.kenngr.mess_offset": 0,
    "set:Z.kenngr.probe_actuation_time_delay": 0,
    "plant:probe.trigger_delay_us": 0,
    "set:channel.meas_error_no_signal": 0,
    "set:channel.use_drive_curr_limit": 0,
}


def _input(row: dict[str, str], column: str) -> Decimal:
    return Decimal(row[column] or UNSET[column])


@dataclass(frozen=True)
class Run:
    """What the manual says about one row; lengths in mm, v in mm/s."""

    type: int
    target: Decimal
    wanted: Decimal
    stroke: Decimal
    stops_with: Decimal
    goes_on: bool

    @property
    def is_lowered(self) -> bool:
        """Types 2 and 4 stop within the stroke: v² = 2 a s (P-AXIS-00086)."""
        return self.type in (2, 4) and self.wanted**2 > 2 * self.stops_with * self.stroke

    @property
    def v(self) -> Decimal:
        """The speed of the run."""
        return (2 * self.stops_with * self.stroke).sqrt() if self.is_lowered else self.wanted

    @property
    def has_signal(self) -> bool:
        """Whether the way of Z, downwards, meets the workpiece."""
        return self.target < SURFACE


def _run(row: dict[str, str]) -> Run:
    text = (PLANS / row["program"]).read_text(encoding="utf-8")
    (mode,) = re.findall(r"#MEAS MODE\[(\S+)\]", text)
    kind = int(row["plc:V.E.TYPE"] if mode == "V.E.TYPE" else mode)
    own = _input(row, "set:Z.kenngr.vb_messen") / 1000
    rapid = _listed("getriebe[0].vb_eilgang") / 1000
    feed = rapid if row["plc:V.E.FEED"] == "" else Decimal(row["plc:V.E.FEED"]) / 60
    return Run(
        kind,
        Decimal(row["plc:V.E.TARGET"]),
        own if kind == 2 else feed,
        _input(row, "set:Z.kenngr.hub_messtaster") / 10000,
        # FCT-C4 2.1, rows 0/0/0 and 0/0/1
        A_FEEDHOLD if _input(row, "set:channel.use_drive_curr_limit") else A,
        "G106" in re.sub(r";.*", "", text),
    )


def _is(text: str, value: Decimal) -> bool:
    """Whether a limit is the value rounded to the digits that are printed, four at least."""
    digits = len(text.partition(".")[2])
    assert digits >= 3, text
    return abs(Decimal(text) - value) <= Decimal(5).scaleb(-digits - 1)


def _range(text: str) -> tuple[str, str]:
    low, high = text.split(" .. ")
    return low, high


def _tolerance(text: str) -> tuple[str, str]:
    middle, width = text.split(" +- ")
    return middle, width


SIGNAL = [name for name, row in ROWS.items() if _run(row).has_signal]
SILENT = [name for name in ROWS if name not in SIGNAL]
BRAKING = [name for name in SIGNAL if not _run(ROWS[name]).goes_on]


def test_every_type_is_there_with_and_without_a_signal() -> None:
    with_signal = {_run(ROWS[name]).type for name in SIGNAL}
    without = {_run(ROWS[name]).type for name in SILENT}
    assert with_signal == without == {1, 2, 3, 4, 5}
    assert {row["rig"] for row in ROWS.values()} == {"rigs/probe-z.toml"}


@pytest.mark.parametrize("case", SIGNAL)
def test_speed_at_contact_is_that_of_the_type(case: str) -> None:
    middle, width = _tolerance(ROWS[case]["check:contact_velocity_mm_s"])
    assert _is(middle, -_run(ROWS[case]).v)
    assert Decimal(width) == Decimal("0.005")


@pytest.mark.parametrize("case", SIGNAL)
def test_latch_error_is_v_times_what_is_late(case: str) -> None:
    """Z moves down. P-AXIS-00487 gives v t_d back, v being known from three rounded positions:
    a quarter of an increment for each would be 4 halves of one, per cycle of the dead time.
    """
    row, v = ROWS[case], _run(ROWS[case]).v
    late = _input(row, "plant:probe.trigger_delay_us") * Decimal("1e-6") + INPUT_DELAY
    given_back = _input(row, "set:Z.kenngr.probe_actuation_time_delay") * Decimal("1e-6")
    middle, width = _tolerance(row["check:latch_error_um"])
    assert _is(middle, -v * (late - given_back) * 1000)
    assert _is(width, INCREMENT * (1 + 2 * given_back / T) * 1000)


def test_calibrated_at_300_and_measured_at_600_is_5_mm_s_times_the_delay_off() -> None:
    """50 um at 10 ms; nothing is left of it with P-AXIS-00487."""
    slow, fast = (
        Decimal(_tolerance(ROWS[f"dead-time-{feed}"]["check:latch_error_um"])[0])
        for feed in (300, 600)
    )
    assert slow - fast == pytest.approx(Decimal(5 * 10) + Decimal("0.02"))
    for feed in (300, 600):
        middle, _ = _tolerance(ROWS[f"dead-time-{feed}-corrected"]["check:latch_error_um"])
        assert abs(Decimal(middle)) <= Decimal("0.04")


@pytest.mark.parametrize("case", BRAKING)
def test_overtravel_and_standstill_of_a_run_that_brakes(case: str) -> None:
    """v (t_late + U + T) + v²/2a + v/Kv with U in [0, T): see test_shipped_bands.py."""
    row, v, a = ROWS[case], _run(ROWS[case]).v, _run(ROWS[case]).stops_with
    late = _input(row, "plant:probe.trigger_delay_us") * Decimal("1e-6") + INPUT_DELAY
    least = v * (late + T) + v * v / (2 * a) + v / KV
    low, high = _range(row["check:overtravel_mm"])
    assert _is(low, least)
    assert _is(high, least + v * T)
    low, high = _range(row["check:standstill_mm"])
    assert _is(low, SURFACE - least - v * T)
    assert _is(high, SURFACE - least)


@pytest.mark.parametrize("case", BRAKING)
def test_reaction_is_that_of_any_run(case: str) -> None:
    low, high = _range(ROWS[case]["check:reaction_ms"])
    least = (INPUT_DELAY + OFFSET) * 1000 - Decimal(SYNC_US) / 1000
    assert _is(low, least)
    assert _is(high, least + T * 1000)


@pytest.mark.parametrize("case", [name for name in SIGNAL if name not in BRAKING])
def test_a_run_that_goes_on_stands_at_its_target(case: str) -> None:
    row, run = ROWS[case], _run(ROWS[case])
    middle, width = _tolerance(row["check:standstill_mm"])
    assert (_is(middle, run.target), Decimal(width)) == (True, Decimal("0.0005"))
    middle, width = _tolerance(row["check:overtravel_mm"])
    assert (_is(middle, SURFACE - run.target), Decimal(width)) == (True, Decimal("0.0005"))
    assert row["check:msg:N40"] == f"== {run.target}"
    assert row["check:reaction_ms"] == ""


@pytest.mark.parametrize("case", SILENT)
def test_without_signal_it_ends_at_the_target_or_as_far_behind_as_allowed(case: str) -> None:
    """P-AXIS-00467 for all but type 3, P-AXIS-00114 for type 2 where 00467 is 0."""
    row, run = ROWS[case], _run(ROWS[case])
    behind = _input(row, "set:Z.kenngr.probing_offset") / 10000
    if run.type == 2:
        behind = behind or _input(row, "set:Z.kenngr.mess_offset") / 10000
    end = run.target - (0 if run.type == 3 else behind)
    middle, width = _tolerance(row["check:standstill_mm"])
    assert (_is(middle, end), Decimal(width)) == (True, Decimal("0.0005"))
    if row["check:alarms"] == "none":
        printed = Decimal(row["check:msg:N40"].removeprefix("== "))
        assert printed == (run.target if run.type == 5 else end)


@pytest.mark.parametrize("case", [name for name in ROWS if _run(ROWS[name]).type == 5])
def test_only_a_signal_jumps_and_makes_the_target_the_actual_position(case: str) -> None:
    """N25, which the jump leaves out, says that the target is reached; N40 prints V.A.PROG."""
    row, run = ROWS[case], _run(ROWS[case])
    assert row["check:msg:N28"] == f"== {int(not run.has_signal)}"
    if run.has_signal:
        assert row["check:msg:N40"] == row["check:standstill_mm"]


@pytest.mark.parametrize("case", ROWS)
def test_alarms_and_merf(case: str) -> None:
    """A missing signal is an alarm always in type 2, by P-CHAN-00176 in 1, never in 3, 4 and 5."""
    row, run = ROWS[case], _run(ROWS[case])
    by_parameter = run.type == 1 and _input(row, "set:channel.meas_error_no_signal") == 1
    is_alarm = not run.has_signal and (run.type == 2 or by_parameter)
    lowered = "== 900222" if run.is_lowered else "none"
    assert row["check:alarms"] == ("== 900004" if is_alarm else lowered)
    merf = "" if is_alarm else f"== {int(run.has_signal)}"
    assert row["check:msg:N30"] == merf
