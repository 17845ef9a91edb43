"""Every limit of the shipped plans, recomputed from closed forms that are written out here.

Nothing of the bench is imported: rigs, lists and plans are read as the text files they are. A limit
must be the formula rounded to the digits that are printed, so that no band can grow unnoticed.
"""

import csv
import math
import re
import tomllib
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

import pytest

PLANS = Path(__file__).parents[2] / "testplans"


def _rows(plan: str) -> dict[str, dict[str, str]]:
    with (PLANS / plan).open(encoding="utf-8", newline="") as file:
        return {row["case"]: row for row in csv.DictReader(file)}


def _list_value(path: Path, name: str) -> Decimal:
    match = re.search(rf"^{re.escape(name)}\s+(\d+)", path.read_text(encoding="utf-8"), re.M)
    assert match is not None, name
    return Decimal(match[1])


LATCH = _rows("latch_accuracy.csv")
MEASURED = [name for name, row in LATCH.items() if row["check:latch_error_um"]]
MANUAL = _rows("manual_examples.csv")


def _is(text: str, value: Decimal, digits: int) -> bool:
    """Whether a limit is the value rounded to so many digits behind the point."""
    assert len(text.partition(".")[2]) == digits, text
    return abs(Decimal(text) - value) <= Decimal(5).scaleb(-digits - 1)


def _range(text: str) -> tuple[str, str]:
    low, high = re.fullmatch(r"(\S+) \.\. (\S+)", text).groups()  # type: ignore[union-attr]
    return low, high


def _tolerance(text: str) -> tuple[str, str]:
    middle, width = re.fullmatch(r"(\S+) \+- (\S+)", text).groups()  # type: ignore[union-attr]
    return middle, width


def _sync_bits() -> int:
    """Bits of SYNC until its end of frame: identifier 0x080, no data, CRC-15, stuffing.

    Source: Bosch CAN 2.0, part A, sections 3.1.1 and 5.
    """
    sent = [0, *(0x080 >> place & 1 for place in range(10, -1, -1)), 0, 0, 0, 0, 0, 0, 0]
    crc = 0
    for bit in sent:
        crc = (crc << 1 & 0x7FFF) ^ (0x4599 if bit ^ crc >> 14 else 0)
    sent += [crc >> place & 1 for place in range(14, -1, -1)]
    stuffed, last, same = 0, -1, 0
    for bit in sent:
        same = same + 1 if bit == last else 1
        last = bit
        if same == 5:
            stuffed, last, same = stuffed + 1, 1 - bit, 1
    return len(sent) + stuffed + 10  # CRC delimiter, two bits of acknowledge, seven of the end


@dataclass(frozen=True)
class Law:
    """What follows for one row: v in mm/s, times in s, a in mm/s2, Kv in 1/s, surface in mm."""

    v: Decimal
    period: Decimal
    offset: Decimal
    contact_to_edge: Decimal
    edge_to_latch: Decimal
    a: Decimal
    kv: Decimal
    feed_forward: Decimal
    surface: Decimal
    increment: Decimal

    @property
    def contact_to_latch(self) -> Decimal:
        """t_l - t_c = pre-travel / v + trigger delay + input delay + filter."""
        return self.contact_to_edge + self.edge_to_latch

    @property
    def least_overtravel(self) -> Decimal:
        """With U = 0.

        physics.md 2(b) with t_d = (t_l - t_c) + U + T. Why: with SYNC k at t_k the first one behind
        the latch, t_k = t_l + U. The drive follows straight lines between set positions, and at t_k
        it stands at s(k-2), since SYNC k brings s(k-1), which is reached at t_k + T. The cycle
        behind SYNC k brakes from s(k-1) on. So the demand comes to rest v²/2a behind s(k-1), that
        is v T + v²/2a behind where it was at t_k, and there the axis was (1-f) v/Kv short of it.
        """
        lag = (1 - self.feed_forward) * self.v / self.kv
        braking = self.v * self.v / (2 * self.a)
        return self.v * (self.contact_to_latch + self.period) + braking + lag

    @property
    def band(self) -> Decimal:
        """U lies in [0, T)."""
        return self.v * self.period


def _law(row: dict[str, str]) -> Law:
    rig_file = PLANS / row["rig"]
    rig = tomllib.loads(rig_file.read_text(encoding="utf-8"))
    axis_list = rig_file.parent / rig["axis"]["Z"]["list"]
    drive = rig["drive"]["servo"]
    v = Decimal(row["plc:V.E.FEED"]) / 60
    a = _list_value(axis_list, "getriebe[0].lslope_profil.a_grenz_stufe_1")
    assert v < 100, "the second step of the slope would need its own term"
    pretravel_mm = Decimal(row["plant:probe.pretravel_um"] or 0) / 1000
    us = Decimal("1e-6")
    return Law(
        v=v,
        period=rig["cycle"]["period_us"] * us,
        offset=rig["cycle"]["cycle_offset_us"] * us,
        contact_to_edge=pretravel_mm / v + Decimal(row["plant:probe.trigger_delay_us"] or 0) * us,
        edge_to_latch=Decimal(str(drive["input_delay_us"])) * us,
        a=a,
        kv=Decimal(row["plant:z.kv"] or rig["plant"]["z"]["start"]["kv"]),
        feed_forward=Decimal(row["plant:z.feed_forward"] or 0),
        surface=Decimal(
            row["plant:probe.surface_mm"] or rig["plant"]["probe"]["start"]["surface_mm"]
        ),
        increment=Decimal(str(drive["lead_mm"])) / drive["encoder_increments"],
    )


def test_the_plan_has_the_cases_that_it_is_about() -> None:
    feeds = {int(LATCH[name]["plc:V.E.FEED"]) for name in MEASURED}
    assert {60, 150, 300, 600, 1000, 1500, 2000, 3000} <= feeds
    edges = {
        (LATCH[name]["set:Z.kenngr.measure.edge"], LATCH[name]["plant:probe.inverted"])
        for name in MEASURED
    }
    assert edges == {("", ""), ("NEG", "1")}
    assert {LATCH[name]["set:Z.kenngr.measure.input"] for name in MEASURED} == {"", "2"}
    assert len(MEASURED) >= 12


@pytest.mark.parametrize("case", MEASURED)
def test_latch_error_is_v_times_the_delay_within_one_increment(case: str) -> None:
    law = _law(LATCH[case])
    middle, width = _tolerance(LATCH[case]["check:latch_error_um"])
    # Z moves down, so a late latch reads low
    assert _is(middle, -law.v * law.contact_to_latch * 1000, 4)
    assert _is(width, law.increment * 1000, 4)


@pytest.mark.parametrize("case", MEASURED)
def test_contact_to_latch_is_the_stated_delay(case: str) -> None:
    """Five times the 2 ns to which two instants are known: two for the guard band, three spare."""
    middle, width = _tolerance(LATCH[case]["check:contact_to_latch_ms"])
    assert _is(middle, _law(LATCH[case]).contact_to_latch * 1000, 5)
    assert Decimal(width) == 5 * Decimal("2e-6")


@pytest.mark.parametrize("case", MEASURED)
def test_overtravel_band_is_the_closed_form_and_v_t_wide(case: str) -> None:
    law = _law(LATCH[case])
    low, high = _range(LATCH[case]["check:overtravel_mm"])
    assert _is(low, law.least_overtravel, 5)
    assert _is(high, law.least_overtravel + law.band, 5)


@pytest.mark.parametrize("case", MEASURED)
def test_standstill_lies_the_overtravel_below_the_surface(case: str) -> None:
    law = _law(LATCH[case])
    low, high = _range(LATCH[case]["check:standstill_mm"])
    assert _is(low, law.surface - law.least_overtravel - law.band, 5)
    assert _is(high, law.surface - law.least_overtravel, 5)


@pytest.mark.parametrize("case", MEASURED)
def test_reaction_band_is_one_period_wide(case: str) -> None:
    """From the edge: input delay, U until the next SYNC is there, then offset less SYNC."""
    law = _law(LATCH[case])
    low, high = _range(LATCH[case]["check:reaction_ms"])
    least = (law.edge_to_latch + law.offset) * 1000 - Decimal(_sync_bits()) / 1000
    assert _is(low, least, 3)
    assert _is(high, least + law.period * 1000, 3)


def test_the_sync_frame_takes_48_bits() -> None:
    """44 bits without data and 4 stuff bits; nothing in it ever changes."""
    assert _sync_bits() == 48


@pytest.mark.parametrize("case", MEASURED)
def test_a_measured_case_has_a_signal_and_no_alarm(case: str) -> None:
    assert LATCH[case]["check:msg:N30"] == "== 1"
    assert LATCH[case]["check:alarms"] == "none"


def test_cases_without_a_value_expect_their_alarm_and_nothing_else() -> None:
    expected = {
        "actuated": ("", "== 50052"),
        "actuated-neg": ("", "== 50052"),
        "not-released": ("", "== 50059"),
        "no-contact": ("== 0", "none"),
        "no-contact-alarm": ("", "== 900004"),
        "latch-pdo-lost": ("", "== 900006"),
    }
    others = {name: row for name, row in LATCH.items() if name not in MEASURED}
    assert {
        name: (row["check:msg:N30"], row["check:alarms"]) for name, row in others.items()
    } == expected
    for row in others.values():
        bands = [
            row[name] for name in row if name.endswith(("_mm", "_ms", "_um")) and "check" in name
        ]
        assert not any(bands)


# The four programs of the manual

B = math.radians(15.0)


@dataclass(frozen=True)
class Expected:
    """Millimetres along Z. trigger: ACS. mess: in the system of the run with all shifts. zero: G92.

    run, then: targets of the measuring run and of both moves behind it.
    """

    trigger: float
    mess: float
    zero: float
    run: float
    then: float

    @property
    def pcs(self) -> float:
        """Without the zero shift."""
        return self.mess - self.zero

    @property
    def offset(self) -> float:
        """MOFFS = MESS - PROG - zero shifts."""
        return self.mess - self.run - self.zero

    def blocks(self, first: int) -> dict[str, float]:
        """What the blocks print; `first` is the number of the MESS block."""
        shown = {
            first: self.mess,
            first + 1: self.trigger,
            first + 2: self.pcs,
            first + 10 - first % 10: self.offset,
        }
        last = max(shown)
        shown |= {
            last + 10: 0.0,
            last + 30: self.offset,
            last + 50: self.then + self.zero + self.offset,
            last + 70: 0.0,
            last + 90: self.then + self.zero,
        }
        return {f"check:msg:N{number}": value for number, value in shown.items()}


PROGRAMS = {
    "meas1": Expected(trigger=100, mess=100, zero=0, run=20, then=100).blocks(30),
    "meas2": Expected(trigger=100, mess=100, zero=33, run=20, then=100).blocks(40),
    "meas3": Expected(trigger=100, mess=100 - 33, zero=0, run=20, then=100).blocks(40),
    # ACS = (0, 0, 75) + Ry(15°) PCS: z = 75 - x sin B + z' cos B with x = 150. Physics.md 2(g)
    "meas4": Expected(
        trigger=55.5,
        mess=(55.5 - 75 + 150 * math.sin(B)) / math.cos(B),
        zero=0,
        run=-10,
        then=50,
    ).blocks(40),
}


def test_the_manual_plan_begins_with_the_four_programs() -> None:
    """The other printed examples: test_manual_examples_bands.py."""
    assert list(MANUAL)[: len(PROGRAMS)] == list(PROGRAMS)
    for name in PROGRAMS:
        row = MANUAL[name]
        assert row["program"] == f"programs/{name}.nc"
        assert row["check:alarms"] == "none"


@pytest.mark.parametrize("case", PROGRAMS)
def test_every_printed_value_is_checked_against_the_closed_form(case: str) -> None:
    """One encoder increment is 10 mm / 2^20 = 0.0000095 mm; the width is that, to five digits."""
    conditions = {
        column: text
        for column, text in MANUAL[case].items()
        if column.startswith("check:msg") and text
    }
    assert set(conditions) == set(PROGRAMS[case])
    for column, text in conditions.items():
        middle, width = _tolerance(text)
        assert abs(float(middle) - PROGRAMS[case][column]) <= 0.5e-6, column
        assert _is(width, Decimal(10) / 2**20, 5), column


@pytest.mark.parametrize("case", PROGRAMS)
def test_the_figures_of_the_manual_beside_it_are_the_rounded_closed_form(case: str) -> None:
    match = re.search(r": ([\d. ]+)\)", MANUAL[case]["title"])
    assert match is not None
    printed = [float(number) for number in match[1].split()]
    assert printed == pytest.approx(list(PROGRAMS[case].values()), abs=0.005)


@pytest.mark.parametrize("case", PROGRAMS)
def test_every_message_of_the_program_is_checked(case: str) -> None:
    text = (PLANS / "programs" / f"{case}.nc").read_text(encoding="utf-8")
    blocks = re.findall(r"^N(\d+) #MSG", text, re.M)
    assert {f"check:msg:N{number}" for number in blocks} == set(PROGRAMS[case])
    top = tomllib.loads((PLANS / MANUAL[case]["rig"]).read_text(encoding="utf-8"))
    surface_mm = top["plant"]["probe"]["start"]["surface_mm"]
    assert f"probe signal at Z = {surface_mm:g} mm" in text
