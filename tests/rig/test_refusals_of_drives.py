"""What the check of a rig refuses of its drives, family by family, and the last value that is good.

Numbers: 500 mm/s (P-AXIS-00212) and cycles of 1 ms, screws of 10 mm.
"""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.contents import settings_of
from axisrig.bench.rig.families import family_of, rig_families
from axisrig.bench.rig.sercos.checks import latch_of
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.profiles.profidrive.parameters import parameters as known_parameters

RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
Check = Callable[..., str]


@pytest.fixture
def check(rig_above: Callable[..., Settings]) -> Check:
    """Return `check(base, *assignments, text=TOML above it)`: the refusal, or ""."""

    def refusal(base: str, *changes: str, text: str = "") -> str:
        settings = rig_above(f"{base}.toml", text, *changes)
        try:
            for family in rig_families():
                family.check(settings)
        except UserError as error:
            return str(error) if error.file else f"without a place: {error}"
        return ""

    return refusal


Case = tuple[tuple[str, ...], str]
AT, MDT = "drive:servo.at=", "drive:servo.mdt="
SERCOS: list[Case] = [
    ((), ""),
    ((f"{AT}S-0-0051 S-0-0130 S-0-0053",), ""),
    ((f"{AT}S-0-0130",), "the AT needs S-0-0051, and each ident once"),
    ((f"{AT}S-0-0051 S-0-0130 S-0-0130",), "the AT needs S-0-0051, and each ident once"),
    ((f"{AT}S-0-0051 S-0-0047",), "the AT cannot carry this ident; found 'S-0-0047'"),
    ((f"{MDT}S-0-0047 S-0-0051",), "the MDT cannot carry this ident; found 'S-0-0051'"),
    ((f"{MDT}S-0-0036",), "the MDT needs S-0-0047"),
    # Input 1: S-0-0130 rising, S-0-0131 falling; input 2: S-0-0132 and 133 (SERCOS, FCT-C4 6.1)
    (("set:Z.kenngr.measure.edge=NEG",), "edge NEG, and the AT of drive servo does not carry"
     " S-0-0131"),
    (("set:Z.kenngr.measure.edge=NEG", f"{AT}S-0-0051 S-0-0131"), ""),
    (("set:Z.kenngr.measure.input=2",), "does not carry S-0-0132"),
    (("set:Z.kenngr.measure.input=2", "set:Z.kenngr.measure.edge=NEG",
      f"{AT}S-0-0051 S-0-0133"), ""),
    (("set:Z.kenngr.messachse=0", f"{AT}S-0-0051"), ""),
]  # fmt: skip


@pytest.mark.parametrize(
    ("at", "lines", "latch"),
    [
        ("S-0-0051 S-0-0130 S-0-0133", "", (2, "NEG")),  # the last one
        ("S-0-0051 S-0-0133 S-0-0130", "", (1, "POS")),
        ("S-0-0051 S-0-0131 S-0-0053", "", (1, "NEG")),
        ("S-0-0051", "", (1, "POS")),
        ("S-0-0051 S-0-0130 S-0-0133", "kenngr.measure.edge NEG", (1, "NEG")),
        ("S-0-0051 S-0-0131 S-0-0130", "kenngr.measure.input 2", (2, "POS")),
    ],
)
def test_the_latch_of_a_sercos_axis_is_that_of_its_list_or_of_its_at(
    at: str,
    lines: str,
    latch: tuple[int, str],
    tmp_path: Path,
    rig_above: Callable[..., Settings],
) -> None:
    """P-AXIS-00517 and 00518 begin with input 1 and POS."""
    text = (RIGS / "lists" / "axis-z-sercos.lst").read_text()
    bare = [line for line in text.splitlines() if ".input " not in line and ".edge " not in line]
    (tmp_path / "z.lst").write_text("\n".join([*bare, lines, ""]))
    settings = rig_above("probe-z-sercos.toml", '[axis.Z]\nlist = "z.lst"', f"{AT}{at}")
    assert latch_of(settings, "Z") == latch


@pytest.mark.parametrize(("changes", "words"), SERCOS)
def test_a_sercos_drive_carries_what_measuring_needs(
    check: Check, changes: tuple[str, ...], words: str
) -> None:
    found = check("probe-z-sercos", *changes)
    assert (words in found) if words else found == ""


@pytest.mark.parametrize(
    ("period_us", "is_good"),
    [(500, True), (1000, True), (2000, True), (8000, True), (1500, False), (750, False),
     (9000, False)],
)  # fmt: skip
def test_a_sercos_cycle_is_half_a_ms_or_whole_ones(
    check: Check, period_us: int, is_good: bool
) -> None:
    text = f"[cycle]\nperiod_us = {period_us}\ncycle_offset_us = {period_us * 3 // 5}"
    found = check("probe-z-sercos", text=text)
    assert ("S-0-0002 is 500 us or whole ms" in found) is not is_good
    assert (found == "") is is_good


FINE = "set:Z.antr.profibus."
PROFIDRIVE: list[Case] = [
    ((), ""),
    ((f"{FINE}feinaufloesung=12",), "a factor of 0.5 (P-AXIS-00065)"),
    (("drive:servo.p1042=12", "drive:servo.p1043=12"), "a factor of 2 (P-AXIS-00065)"),
    (("drive:servo.p1042=12", "drive:servo.p1043=12", f"{FINE}feinaufloesung=12"), ""),
    ((f"{FINE}p1042=9",), "a factor of 4 (P-AXIS-00316)"),
    ((f"{FINE}feinaufloesung=0",), "a factor of 2048 (P-AXIS-00065)"),
    (("drive:servo.p1042=0", "drive:servo.p1043=0", f"{FINE}feinaufloesung=0"), ""),
    ((f"{FINE}p1043=13",), "a factor of 0.25 (P-AXIS-00317)"),
    ((f"{FINE}p1042=11", f"{FINE}p1043=11"), ""),
    (("drive:servo.p0880=8192",), "a factor of 0.5 (P-AXIS-00379)"),
    (("drive:servo.p0880=8192", f"{FINE}drive_velocity_base_value=8192"), ""),
    (("set:Z.kenngr.measure.input=2",), "one probe at its encoder, I0.x (P-AXIS-00517)"),
    (("set:Z.kenngr.measure.input=2", "set:Z.kenngr.messachse=0"), ""),
]


@pytest.mark.parametrize(("changes", "words"), PROFIDRIVE)
def test_a_list_counts_as_its_profidrive_drive_does(
    check: Check, changes: tuple[str, ...], words: str
) -> None:
    found = check("probe-z-profidrive", *changes)
    assert (words in found) if words else found == ""


FUNCTION = "set:Z.antr.function[0]."


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ((), ""),
        (("commu=CYCLIC",), "no word of the telegram is known to carry it (P-AXIS-00397)"),
        (("wr_ident[0]=9999",), "the drive has no such parameter (P-AXIS-00398)"),
        (("data_type=UNS16",), "another data type (P-AXIS-00399)"),
    ],
)
def test_functions_of_a_profidrive_drive_are_those_of_its_parameters(
    check: Check, changes: tuple[str, ...], words: str
) -> None:
    """A parameter of 32 bits, given as such, can be written beside the cycle."""
    number, row = next((n, row) for n, row in known_parameters().items() if row.bits == 32)
    kind = "SGN32" if row.is_signed else "UNS32"
    given = {"id": "OWN", "wr_ident[0]": str(number), "data_type": kind, "commu": "ACYCLIC"}
    given |= dict(change.split("=") for change in changes)
    found = check("probe-z-profidrive", *(f"{FUNCTION}{k}={v}" for k, v in given.items()))
    assert (words in found) if words else found == ""
    assert "without a place" not in found


@pytest.mark.parametrize("family", ["conventional", "encoder-terminal"])
@pytest.mark.parametrize(
    ("rpm", "is_good"), [("3000", True), ("3000.09", True), ("3000.1", False), ("2999.9", False)]
)
def test_the_output_of_the_list_is_that_of_the_drive_to_a_count(
    check: Check, family: str, rpm: str, is_good: bool
) -> None:
    """32767 at 30 m/min are 3000 rpm of 10 mm: 10.92 counts for each rpm."""
    found = check(f"probe-z-{family}", f"drive:servo.rpm_at_10v={rpm}")
    assert (found == "") is is_good
    if not is_good:
        factor = float(rpm) / 3000
        assert f"speeds wrong by a factor of {factor:.6g} (P-AXIS-00129" in found


@pytest.mark.parametrize(
    ("counts", "turns", "is_good"),
    [(32_766, 30, False), (327_661, 300, True), (327_679, 300, True), (32_768, 30, False)],
)
def test_one_count_of_the_output_is_one_too_much(
    check: Check, counts: int, turns: int, is_good: bool, tmp_path: Path
) -> None:
    """30 m/min at the full output: 32767 counts by the rig."""
    own = (RIGS / "lists" / "axis-z-conventional.lst").read_text("utf-8").splitlines()
    lines = [line for line in own if "multi_gain" not in line]
    lines += [f"getriebe[0].multi_gain_z {counts}", f"getriebe[0].multi_gain_n {turns}", ""]
    (tmp_path / "z.lst").write_text("\n".join(lines), "utf-8")
    found = check("probe-z-conventional", text='[axis.Z]\nlist = "z.lst"')
    assert ("to less than one" in found) is not is_good
    assert (found == "") is is_good


@pytest.mark.parametrize(
    ("lines", "missing", "is_good"),
    [(40_959, 3, True), (40_960, 3, False), (81_919, 1, True), (81_920, 1, False)],
)
def test_a_counter_of_16_bits_may_not_wrap_unseen(
    check: Check, lines: int, missing: int, is_good: bool
) -> None:
    """Half of 65536 counts, four for each line: 2 mm in 4 cycles, or 1 mm in 2."""
    changes = (f"drive:servo.lines={lines}", f"drive:servo.missing_cycles={missing}")
    found = check("probe-z-encoder-terminal", *changes)
    assert (found == "") is is_good
    way_mm = (missing + 1) * 0.5
    words = f"at P-AXIS-00212 it goes {way_mm:g} mm in {missing + 1} cycles"
    assert (words in found) is not is_good
    assert check("probe-z-conventional", *changes) == ""  # its counter is longer


@pytest.mark.parametrize(
    ("variable", "missing", "is_good"),
    [("LATCH16", 8, True), ("LATCH16", 9, False), ("LATCH32", 9, True), ("LATCH32", 500, True)],
)
def test_a_latch_within_a_turn_needs_half_a_turn(
    check: Check, variable: str, missing: int, is_good: bool
) -> None:
    """4.5 mm in 9 cycles are less than 5 mm, and 5 mm in 10 are not."""
    changes = (f"drive:servo.latch_variable={variable}", f"drive:servo.missing_cycles={missing}")
    found = check("probe-z-lightbus", *changes)
    assert (found == "") is is_good
    assert ("nobody knows in which turn LATCH16 was" in found) is not is_good


def test_a_card_of_the_control_has_no_bus(check: Check) -> None:
    found = check("probe-z-conventional", "bus:card.bus_us=10", "bus:card.output_us=10")
    assert "a conventional drive is at a card of the control, and has no bus" in found


@pytest.mark.parametrize(
    ("base", "text", "words"),
    [
        ("probe-z-ethercat", '[segment.ec2]\ncarrier = "ethercat"', "no axis is on segment ec2"),
        ("probe-z-profidrive", '[segment.two]\ncarrier = "cyclic"', "no axis is on segment two"),
        ("probe-z-ethercat", "[cycle]\nsync_counter = 10", "sync_counter is about CAN and no"),
        ("probe-z-ethercat", "[cycle]\nheartbeat_ms = 10", "heartbeat_ms is about CAN and no"),
        ("probe-xyz-mixed", "[cycle]\nheartbeat_ms = 10", ""),
        ("plc-timestamp-line", "[segment.ec1]\ndc = false", "the line has none"),
        ("plc-timestamp-line", "[plc]\nclock_offset_ns = 5", "its clock is that of its slave"),
        ("plc-timestamp-line", "[plc]\nclock_drift_ppm = 5.0", "its clock is that of its slave"),
        ("plc-timestamp-ethercat", "[plc]\nclock_offset_ns = 5", ""),  # of a fieldbus of its own
    ],
)
def test_a_segment_has_what_its_carrier_needs(
    check: Check, base: str, text: str, words: str
) -> None:
    found = check(base, text=text)
    assert (words in found) if words else found == ""


# --- what is reported and not refused


@pytest.mark.parametrize(
    ("base", "changes", "words"),
    [
        ("probe-z-lightbus", ("in2mode=25",), "in2mode of its drive is 25 and not 26"),
        ("probe-z-profidrive", ("p0660=0",), "p0660 of its drive is 0 and not 80"),
        ("probe-z-profidrive", ("p0660=81",), "p0660 of its drive is 81 and not 80"),
        ("probe-z-lightbus", ("in2mode=0",), "in2mode of its drive is 0 and not 26"),
        ("probe-z-sercos", ("idents=S-0-0307=S-0-0409",), "no real-time bit has S-0-0401"),
        # A bit that the control sends (S-0-0301, S-0-0303) says nothing of the drive
        (
            "probe-z-sercos",
            ("idents=S-0-0307=S-0-0409 S-0-0301=S-0-0401 S-0-0303=S-0-0401",),
            "no real-time bit has S-0-0401",
        ),
        ("probe-z-sercos", ("latch_check=false",), "S-0-0130; nothing proves it"),
        (
            "probe-z-ethercat",
            ("latch_check=false",),
            "axis Z: its latches are unproved: latch_check of drive servo is false; ",
        ),
        ("probe-z-profidrive", ("p1043=10", "position_check=true"), "has other fine bits (p1043)"),
    ],
)
def test_what_makes_a_measurement_doubtful_is_reported(
    base: str, changes: tuple[str, ...], words: str
) -> None:
    def lines(*keys: str) -> str:
        settings = settings_of(RIGS / f"{base}.toml", [f"drive:servo.{key}" for key in keys])
        return "\n".join(family_of(settings, "Z").describe(settings))

    assert words in lines(*changes)
    assert words not in lines()


@pytest.mark.parametrize(
    ("base", "change", "words"),
    [
        ("probe-z-lightbus", "in2mode=0", "in2mode"),
        ("probe-z-profidrive", "p0660=0", "p0660"),
        ("probe-z-sercos", "idents=S-0-0307=S-0-0409", "no real-time bit"),
        ("probe-z-sercos", "latch_check=false", "nothing proves it"),
        ("probe-z-ethercat", "latch_check=false", "latches are unproved"),
    ],
)
def test_an_axis_that_does_not_measure_is_not_warned_of(base: str, change: str, words: str) -> None:
    """Or that measures with what is wired to the PLC."""
    for further, is_warned in (
        ([], True),
        (["set:Z.kenngr.messachse=0"], False),
        (["set:Z.kenngr.measure.signal=PLC"], False),
    ):
        if "ethercat" in base and "signal" in "".join(further):
            continue  # its latch is kept ready all the same
        settings = settings_of(RIGS / f"{base}.toml", [f"drive:servo.{change}", *further])
        found = "\n".join(family_of(settings, "Z").describe(settings))
        assert (words in found) is is_warned, further


@pytest.mark.parametrize(
    ("base", "table", "words"),
    [
        ("distance-z-ethercat", "pdo-second-every-2", "TPDO4 comes with every 2. SYNC only"),
        ("distance-z-ethercat", "pdo-second-event", ""),  # in the image of each cycle all the same
        ("distance-z", "pdo-second-every-2", ""),
    ],
)
def test_a_process_image_carries_each_value_in_every_cycle(
    check: Check, base: str, table: str, words: str
) -> None:
    path = RIGS / "lists" / f"{table}.csv"
    found = check(base, text=f'[drive.servo]\npdo_map = "{path.as_posix()}"')
    assert words in found
    assert ("; found 2; allowed: 1, 254, 255" in found) is bool(found) is bool(words)


@pytest.mark.parametrize(
    ("base", "is_good"),
    [("probe-z", False), ("probe-z-sercos", False), ("probe-z-profidrive", False),
     ("probe-z-conventional", True)],
)  # fmt: skip
def test_the_scale_of_an_output_in_a_list_is_for_drives_that_have_one(
    base: str, is_good: bool, tmp_path: Path, rig_above: Callable[..., Settings]
) -> None:
    """P-AXIS-00128 and 00129; others would run as if they were not there."""
    own = (RIGS / "lists" / f"axis-{base.removeprefix('probe-')}.lst").read_text("utf-8")
    bare = [line for line in own.splitlines() if "multi_gain" not in line]
    for key in ("multi_gain_z", "multi_gain_n"):
        (tmp_path / "z.lst").write_text("\n".join([*bare, f"getriebe[0].{key} 7", ""]), "utf-8")
        text = '[axis.Z]\nlist = "z.lst"'
        if is_good:
            notes = rig_above(f"{base}.toml", text).notes
            assert not [note for note in notes if key in note]
            continue
        with pytest.raises(UserError, match=rf"{key} .*does not act here"):
            rig_above(f"{base}.toml", text)


@pytest.mark.parametrize(
    ("bits", "offset", "step_um_s", "offset_um_s"),
    [(16, 0, 15.26, 0.0), (12, -100, 244.1, -1526.0), (8, 50, 3906.0, 763.0)],
)
def test_an_output_has_its_step_and_its_offset_with_its_sign(
    bits: int, offset: int, step_um_s: float, offset_um_s: float
) -> None:
    """500 mm/s at 32767 of 16 bits; the lag is speed by Kv, which is 20/s here."""
    keys = [f"drive:servo.output_bits={bits}", f"drive:servo.output_offset={offset}"]
    changes = [*keys, "set:Z.getriebe[0].kv=2000"]
    settings = settings_of(RIGS / "probe-z-conventional.toml", changes)
    (line,) = [one for one in family_of(settings, "Z").describe(settings) if "output of" in one]
    assert f"output of {bits} bits, 500 mm/s at the full one" in line
    found = re.findall(r"(-?[\d.]+) um", line)
    expected = [step_um_s, step_um_s / 20, offset_um_s, offset_um_s / 20]
    assert [float(one) for one in found] == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize(
    ("xist1", "absolute", "bits", "refused"),
    [
        (12, 10, {"feinaufloesung": 12}, None),
        (12, 10, {"feinaufloesung": 12, "p1042": 12, "p1043": 10}, None),
        (12, 10, {"feinaufloesung": 12, "p1042": -1, "p1043": -1}, None),
        (12, 10, {"feinaufloesung": 10}, ("00065", "p1042", 10, 12, "4")),
        (12, 10, {"feinaufloesung": 12, "p1042": 10}, ("00316", "p1042", 10, 12, "4")),
        (12, 10, {"feinaufloesung": 12, "p1043": 12}, ("00317", "p1043", 12, 10, "0.25")),
        (12, 10, {"feinaufloesung": 12, "p1043": 11}, ("00317", "p1043", 11, 10, "0.5")),
        (11, 11, {"feinaufloesung": 11, "p1043": 0}, ("00317", "p1043", 0, 11, "2048")),
        (11, 12, {"feinaufloesung": 11, "p1042": 12}, ("00316", "p1042", 12, 11, "0.5")),
        (11, 12, {"feinaufloesung": 11, "p1042": 11, "p1043": 12}, None),
        # The first of the three
        (11, 12, {"feinaufloesung": 12, "p1042": 12, "p1043": 11},
         ("00065", "p1042", 12, 11, "0.5")),
        (11, 12, {"feinaufloesung": 11, "p1042": 12, "p1043": 11},
         ("00316", "p1042", 12, 11, "0.5")),
    ],
)  # fmt: skip
def test_fine_bits_of_each_position_are_those_that_the_drive_has_for_it(
    check: Check,
    xist1: int,
    absolute: int,
    bits: dict[str, int],
    refused: tuple[str, str, int, int, str] | None,
) -> None:
    """G1_XIST1 has p1042, the absolute position p1043; a bit is a factor of 2, -1 sets none."""
    listed = [f"set:Z.antr.profibus.{key}={number}" for key, number in bits.items()]
    drive = (f"drive:servo.p1042={xist1}", f"drive:servo.p1043={absolute}")
    found = check("probe-z-profidrive", *drive, *listed)
    if refused is None:
        assert "fine bits" not in found
        return
    number, key, value, allowed, factor = refused
    assert (
        f"axis Z: its drive has other fine bits ({key} of the rig): positions wrong by a factor of"
        f" {factor} (P-AXIS-{number}); found {value}; allowed: {allowed}"
    ) in found


@pytest.mark.parametrize(
    ("key", "value", "own"),
    [("clock_offset_ns", "5", "clock_start_us"), ("clock_drift_ppm", "-5.0", "drift_ppm")],
)
def test_a_clock_of_a_terminal_on_a_line_is_set_where_that_of_each_slave_is(
    check: Check, key: str, value: str, own: str
) -> None:
    found = check("plc-timestamp-line", text=f"[plc]\n{key} = {value}")
    assert f"found {value}; [segment.ec1] {own} = {{ terminal = ... }}" in found
