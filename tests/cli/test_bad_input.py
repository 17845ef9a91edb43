"""Programs, rigs and parameter lists that cannot be used, and what is said about them.

Each row is one mistake: exit code 2, and the message names file, line and column where there are
some, what stands there, and what may stand there.
"""

import re
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import pytest

Outcome = tuple[int, str, str]
Call = Callable[..., Outcome]
Reject = Callable[..., str]

FEED = ("--set", "plc:V.E.FEED=3000")


def _table(names: str, rows: Iterable[Any], *, named: bool = False) -> pytest.MarkDecorator:
    """Make the cases of a table whose rows begin with their name; named: the test takes it too."""
    return pytest.mark.parametrize(
        names.split(),
        [
            pytest.param(
                *(row if named else row[1:]),
                id=row[0][:40] or "empty",
            )
            for row in rows
        ],
    )


def _holds(message: str, *fragments: str) -> None:
    for fragment in fragments:
        assert fragment in message, message


# ---- NC programs

PROGRAMS = [
    ("unknown word", "N10 G1 Z132 Q5 F100\n", ["part.nc:1:13:", "'Q'", "allowed: Z"]),
    ("unknown G", "N10 G90\nN20 G999 Z1 F1\n", ["part.nc:2:5:", "'G999'", "G100", "G102"]),
    ("G159 alone", "N10 G159\n", ["part.nc:1:5:", "needs a group", "G159 = 0 .. 96"]),
    ("two offsets", "N1 G159=7 G54\n", ["part.nc:1:11:", "G159 and G54 exclude each other"]),
    ("unknown command", "N10 #MESS MODE[2]\n", ["part.nc:1:5:", "'#MESS MODE'", "#MEAS MODE"]),
    ("unknown variable", 'N1 #MSG["%f",V.A.MEES.Z]\n', ["part.nc:1:14:", "nearest: V.A.MESS.Z"]),
    ("axis not there", "N10 G1 Z132\nN20 X10 F100\n", ["part.nc:2:5:", "'X'", "allowed: Z"]),
    ("feed 0", "N10 G1 Z132 F0\n", ["part.nc:1:13:", "'F0'", "greater than 0"]),
    ("feed below 0", "N10 G1 Z132 F-1\n", ["part.nc:1:13:", "'F-1'", "greater than 0"]),
    ("no number", "N10 G1 Z F100\n", ["part.nc:1:8:", "axis Z has no value", "allowed: Z10"]),
    ("division by zero", "N10 G1 Z=1/0 F100\n", ["part.nc:1:10:", "division by zero"]),
    ("root of -1", "N10 G1 Z=SQRT[-1] F100\n", ["part.nc:1:10:", "square root of -1"]),
    ("no tangent", "N10 G1 Z=TAN[90] F100\n", ["part.nc:1:10:", "tangent of 90"]),
    ("overflow", f"G1 Z={'9' * 300}*{'9' * 300} F1\n", ["part.nc:1:6:", "number too large"]),
    ("no double", f"G1 Z132 F{'9' * 400}\n", ["part.nc:1:9:", "too large", "'999999999999..'"]),
    ("huge block number", f"N{'9' * 5000} M30\n", ["part.nc:1:1:", "number too large"]),
    ("open bracket", "N10 G1 Z=[1+2 F100\n", ["part.nc:1:10:", "not closed", "allowed: ]"]),
    ("500 brackets", f"G1 Z={'[' * 500}1{']' * 500} F1\n", ["part.nc:1:26:", "nested too deep"]),
    ("open text", 'N10 #MSG["x]\n', ["part.nc:1:10:", "text is not closed"]),
    ("unknown format", 'N10 #MSG["%q",1]\n', ["part.nc:1:11:", "'%q'", "%f, %d"]),
    ("few values", 'N10 #MSG["%f %f",1]\n', ["part.nc:1:11:", "'1 values'", "allowed: 2 values"]),
    ("measuring type", "N10 #MEAS MODE[99]\n", ["part.nc:1:5:", "'99'", "1, 2, 3, 4, 5, 6, 7"]),
    ("two feeds", "N10 G1 Z132 F100 F200\n", ["part.nc:1:18:", "second feed"]),
    ("G0 and G1", "N10 G0 G1 Z132 F100\n", ["part.nc:1:8:", "exclude each other"]),
    ("NUL", "N10 G1 Z132 F100\0\n", ["part.nc:1:17:", r"found '\x00'"]),
    ("no-break space", "N10 G1 Z132\u00a0F3000\n", ["part.nc:1:12:", r"found '\xa0'"]),
    ("two mistakes", "N10 G1 Z132 F100\r\nN20 G7\r\nN30 Q\r\n", ["part.nc:2:5:", "'G7'"]),
    ("empty", "", ["part.nc", "empty"]),
    ("blank", "\n  \n\t\n", ["part.nc", "empty"]),
    ("comments only", "; nothing\n( here )\n", ["part.nc", "empty"]),
]


@_table("text fragments", PROGRAMS)
def test_program_is_rejected(
    place: Path, rejected: Reject, text: str, fragments: list[str]
) -> None:
    (place / "part.nc").write_bytes(text.encode())
    _holds(rejected("nc", "part.nc", "--rig", "rig.toml"), *fragments)


UNREADABLE = [
    ("binary nc", "part.nc", bytes(range(256)), ["UTF-8"]),
    ("utf-16 nc", "part.nc", "M30\n".encode("utf-16"), ["UTF-8"]),
    ("binary rig", "rig.toml", bytes(range(256)), ["UTF-8"]),
    ("latin-1 rig", "rig.toml", "# Müll\n".encode("latin-1"), ["UTF-8"]),
    ("utf-16 rig", "rig.toml", "M30\n".encode("utf-16"), ["UTF-8"]),
]


@_table("file content fragments", UNREADABLE)
def test_file_that_is_no_text(
    place: Path, rejected: Reject, file: str, content: bytes, fragments: list[str]
) -> None:
    (place / file).write_bytes(content)
    _holds(rejected("nc", "part.nc", "--rig", "rig.toml"), file, *fragments)


def test_missing_files_and_folders_in_their_place(place: Path, rejected: Reject) -> None:
    _holds(rejected("nc", "no.nc", "--rig", "rig.toml"), "no.nc")
    _holds(rejected("nc", "lists", "--rig", "rig.toml"), "lists", "directory")
    _holds(rejected("nc", "part.nc", "--rig", "no.toml"), "no.toml", "not found")
    _holds(rejected("nc", "part.nc", "--rig", "lists"), "lists")
    (place / "rig.toml").write_text(" \n", encoding="utf-8")
    _holds(rejected("nc", "part.nc", "--rig", "rig.toml"), "rig.toml", "empty")


@pytest.mark.parametrize(
    "text",
    [
        "\ufeffN10\tG1\tZ131\tF3000\r\nN20 M30\r\n",
        "N10 G1 Z131 F3000\rN20 M30\r",
        "N10 G1 Z131 F3000",
        f'N10 #MSG["ü€ {"x" * 100_000}"]\nM30\n',
        f"N10 G1 Z={'-' * 501}-131 F3000\nM30\n",
    ],
    ids=["BOM, tabs and CRLF", "CR", "no M30, no line end", "long line", "many signs"],
)
def test_odd_text_that_is_right(place: Path, axisrig: Call, text: str) -> None:
    (place / "part.nc").write_bytes(text.encode())
    code, _, err = axisrig("nc", "part.nc", "--rig", "rig.toml")
    assert (code, err) == (0, "")


ALARMS = [
    ("no feed", "N10 G1 Z132\n", "ID 20008 class 2:", "line 1, block N10"),
    ("feed from outside", "N10 G1 Z132 F=V.E.FEED\n", "ID 20008", "line 1, block N10"),
    ("no value yet", 'N10 #MSG["%f", V.A.MESS.Z]\n', "ID 900101", "V.A.MERF"),
    (
        "stop of no axis",
        "#MEAS MODE[V.E.FEED+12]\nN20 G100 Z1 F100\n",
        "ID 900241",
        "line 2, block N20",
    ),
    ("no #CS", "N10 #CS OFF\n", "ID 900108", "line 1, block N10"),
    ("past the encoder, slow", "N10 G1 Z30000 F100\n", "ID ", "line 1, block N10"),
    ("past the encoder, rapid", "N10 G0 Z-1000000000\n", "ID ", "line 1, block N10"),
    ("past any double", f"N10 G1 Z1{'0' * 300} F100\n", "ID ", "line 1, block N10"),
]


@_table("text alarm place_of", ALARMS)
def test_alarm_ends_the_program_with_code_1(
    place: Path, axisrig: Call, text: str, alarm: str, place_of: str
) -> None:
    (place / "part.nc").write_text(text + "M30\n", encoding="utf-8")
    given = ["--set", "plc:V.E.FEED=-5"] if "V.E.FEED" in text else []
    code, out, err = axisrig("nc", "part.nc", "--rig", "rig.toml", *given)
    assert (code, out) == (1, ""), err
    _holds(err, alarm, place_of)


# ---- rigs: one text replaced, the line counted here

RIGS = [
    ("key", "lead_mm = 10", "leadmm = 10", ["unknown rig key", "leadmm", "did you mean lead_mm?"]),
    ("table", "[cycle]", "[cycel]", ["unknown rig key cycel", "did you mean cycle?"]),
    ("top key", "title =", "titel =", ["unknown rig key titel", "did you mean title?"]),
    ("below range", "period_us = 1000", "period_us = -1", ["cycle.period_us", "250", "-1"]),
    (
        "fraction",
        "period_us = 1000",
        "period_us = 1000.5",
        ["cycle.period_us", "whole number", "1000.5"],
    ),
    (
        "text",
        "period_us = 1000",
        'period_us = "fast"',
        ["cycle.period_us", "whole number", "'fast'"],
    ),
    ("nan", "lead_mm = 10.0", "lead_mm = nan", ["drive.servo.lead_mm", "nan"]),
    ("inf", "lead_mm = 10.0", "lead_mm = inf", ["drive.servo.lead_mm", "inf"]),
    ("huge lead", "lead_mm = 10.0", "lead_mm = 1e300", ["lead_mm"]),
    ("lead below a micrometre", "lead_mm = 10.0", "lead_mm = 0.0005", ["lead_mm"]),
    ("lead of part micrometres", "lead_mm = 10.0", "lead_mm = 10.0005", ["lead_mm"]),
    ("huge delay", "lead_mm = 10.0", "input_delay_us = 1e300", ["input_delay_us"]),
    ("no grid", "lead_mm = 10.0", "sample_us = 1e-9", ["sample_us"]),
    ("increments", "1_048_576", "1" + "0" * 30, ["encoder_increments", "67108864"]),
    ("offset", "cycle_offset_us = 600", "cycle_offset_us = 1000", ["allowed: 0 .. 999 us"]),
    ("bit rate", "bitrate = 1_000_000", "bitrate = 123", ["125000", "1000000", "123"]),
    ("node", "node = 3", "node = 128", ["axis.Z.node", "127"]),
    ("segment", 'segment = "can1"', 'segment = "can9"', ["'can9'", "allowed: can1"]),
    ("drive", 'drive = "servo"', 'drive = "sevro"', ["'sevro'", "allowed: servo"]),
    ("axis on a probe", 'plant = "z"', 'plant = "probe"', ["'probe'", "allowed: z"]),
    ("probe on an axis", 'probe_1 = "probe"', 'probe_1 = "z"', ["'z'", "allowed: probe"]),
    ("wire to nothing", 'z = "z" }', 'z = "q" }', ["'q'", "allowed: z"]),
    ("wire from nothing", '{ z = "z" }', '{ q = "z" }', ["'q'", "allowed: x, y, z"]),
    ("wire of a number", '{ z = "z" }', "{ z = 1 }", ["plant.probe.wire", "found 1"]),
    ("no wire", '{ z = "z" }', "{}", ["wired to no axis"]),
    ("variable", "surface_mm", "surfac_mm", ["'surfac_mm'", "did you mean: surface_mm"]),
    ("unit", "surface_mm", "surface_furlong", ["'surface_furlong'", "no unit of surface"]),
    ("unit of a time", "surface_mm", "surface_us", ["another unit", "'us'"]),
    ("text for a number", "surface_mm = 129", 'surface_mm = "a"', ["surface_mm", "'a'", "number"]),
    ("nan for a number", "surface_mm = 129", "surface_mm = nan", ["surface_mm", "nan", "number"]),
    ("true for a number", "surface_mm = 129", "surface_mm = true", ["surface_mm", "number"]),
    ("7 for a switch", "surface_mm = 129", "inverted = 7", ["'7'", "true, false"]),
    ("switch with a unit", "surface_mm = 129", "inverted_mm = 1", ["inverted"]),
    ("an output", "surface_mm = 129", "signal = true", ["can be set", "allowed: normal_x"]),
    ("blank in a name", "surface_mm = 129", '"a b" = 1', ["a b"]),
    ("range of an FMU", "kv = 40", "kv = -40", ["kv", "-40"]),
    ("no direction", "surface_mm = 129", "normal_z = 0", ["unit vector"]),
    ("past the encoder", "_mm = 130", "_mm = 20490", ["axis Z", "20490", "-20480 .. 20480"]),
    ("model", "ServoAxis", "ServoAxs", ["did you mean: AxisRig.Drives.ServoAxis"]),
    ("no .fmu", "AxisRig.Drives.ServoAxis", "model.zip", ["model.zip", "ends in .fmu"]),
    ("FMU not there", "AxisRig.Drives.ServoAxis", "no.fmu", ["no.fmu", "not found"]),
    ("list not there", "axis-z.lst", "no.lst", ["no.lst", "is no file"]),
    ("list is a number", '"lists/axis-z.lst"', "3", ["axis.Z.list", "found 3"]),
    (
        "table is a number",
        '[axis.Z]\nlist = "lists/axis-z.lst"',
        '[axis]\nZ = 5\n[axis.Y]\nlist = "lists/axis-z.lst"',
        ["5"],
    ),
    ("NC word as axis", "[axis.Z]", "[axis.F]", ["F"]),
    ("text not closed", '"one axis"', '"one', ["rig.toml:1:", "no valid TOML"]),
    (
        "text without quotes",
        'title = "one axis"',
        "title = one axis",
        ["rig.toml:1:", 'a text is in quotes: title = "one axis"'],
    ),
    (
        "quote missing",
        'title = "one axis"',
        'title = one axis"',
        ["rig.toml:1:", 'a text is in quotes: title = "one axis"'],
    ),
    (
        "decimal comma",
        "lead_mm = 10.0",
        "lead_mm = 10,5",
        ["no valid TOML", "a decimal point, not a comma: lead_mm = 10.5"],
    ),
    ("digits beyond Python", "period_us = 1000", f"period_us = {'9' * 5000}", ["rig.toml"]),
    ("nesting beyond Python", '"one axis"', "[" * 3000 + "]" * 3000, ["rig.toml"]),
]
# What is wrong there is no matter of the replaced line alone.
ELSEWHERE = {
    "digits beyond Python", "nesting beyond Python", "NC word as axis", "no direction",
    "table is a number",
}  # fmt: skip


@pytest.mark.long(but=1)
@_table("name old new fragments", RIGS, named=True)
def test_rig_is_rejected(
    place: Path, rejected: Reject, name: str, old: str, new: str, fragments: list[str]
) -> None:
    text = (place / "rig.toml").read_text(encoding="utf-8")
    assert text.count(old) >= 1
    (place / "rig.toml").write_text(text.replace(old, new, 1), encoding="utf-8")
    message = rejected("nc", "part.nc", "--rig", "rig.toml", *FEED)
    _holds(message, *fragments)
    if name not in ELSEWHERE:
        line = text[: text.index(old)].count("\n") + 1
        assert re.search(rf"rig\.toml:{line}\b", message), message


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (row[1], row[2])
        for row in RIGS
        if row[0] in {"FMU not there", "wire to nothing", "variable"}
    ],
)
def test_check_looks_at_the_plants_too(place: Path, rejected: Reject, old: str, new: str) -> None:
    text = (place / "rig.toml").read_text(encoding="utf-8")
    (place / "rig.toml").write_text(text.replace(old, new, 1), encoding="utf-8")
    assert new.split(" ", maxsplit=1)[0].strip('"') in rejected("check", "rig.toml")


def test_axes_that_differ_in_case_alone_are_refused(place: Path, axisrig: Call) -> None:
    """And `z` is no name of an axis: both mistakes are reported."""
    text = (place / "rig.toml").read_text(encoding="utf-8")
    twice = text + '\n[axis.z]\nlist = "lists/free.lst"\nsegment = "can1"\nnode = 4\n'
    twice += 'drive = "servo"\nplant = "y"\n[plant.y]\nfmu = "AxisRig.Drives.ServoAxis"\n'
    listed = (place / "lists/axis-z.lst").read_text(encoding="utf-8")
    free = re.sub("kopf.log_achs_name.*", "", listed)
    (place / "lists/free.lst").write_text(free, encoding="utf-8")
    (place / "rig.toml").write_text(twice.replace("offset_us = 600", "offset_us = 640"), "utf-8")
    code, out, err = axisrig("check", "rig.toml")
    assert (code, out) == (2, "")
    first, second = err.removeprefix("error: ").split("\nerror: ")
    _holds(first, "free.lst:2:", "axes Z and z")
    _holds(second, "found 'z'", "allowed: one of A B C")


def test_cycle_that_does_not_fit_is_told_with_the_arithmetic(place: Path, rejected: Reject) -> None:
    text = (place / "rig.toml").read_text(encoding="utf-8")
    (place / "rig.toml").write_text(text.replace("1_000_000", "125_000"), encoding="utf-8")
    message = rejected("nc", "part.nc", "--rig", "rig.toml", *FEED)
    # SYNC, RPDO1, TPDO1 and the latch TPDO: 55 + 135 + 135 + 95 bits of 8 us
    _holds(message, "rig.toml:10", "3360.0 of 1000.0 us", "longer period_us")


@pytest.mark.parametrize(
    ("base", "fragments"),
    [
        ('"no.toml"', ["no.toml", "not found"]),
        ('"lists"', ["lists"]),
        ("3", ["`base`", "found 3"]),
        ('"over.toml"', ["over.toml", "circle"]),
        ('"other.toml"', ["circle"]),
    ],
    ids=["missing", "folder", "number", "itself", "circle of two"],
)
def test_base_of_a_rig(place: Path, rejected: Reject, base: str, fragments: list[str]) -> None:
    (place / "over.toml").write_text(f"base = {base}\n", encoding="utf-8")
    (place / "other.toml").write_text('base = "over.toml"\n', encoding="utf-8")
    _holds(rejected("check", "over.toml"), *fragments)


def test_mistake_in_a_base_is_told_with_the_file_that_makes_it(
    place: Path, rejected: Reject
) -> None:
    (place / "over.toml").write_text('base = "rig.toml"\n[axis.Z]\nnode = 500\n', encoding="utf-8")
    _holds(rejected("check", "over.toml"), "over.toml:3", "127", "500")
    text = (place / "rig.toml").read_text(encoding="utf-8").replace("node = 3", "node = 300")
    (place / "rig.toml").write_text(text, encoding="utf-8")
    (place / "over.toml").write_text('base = "rig.toml"\n', encoding="utf-8")
    _holds(rejected("check", "over.toml"), "rig.toml:20", "300")


# ---- parameter lists: a line added to axis-z.lst; the number is the column of the mistake

LISTS = [
    ("unknown", "kenngr.meassure.edge POS", 1, ["nearest names: kenngr.measure.edge"]),
    ("of the channel", "messtyp 1", 1, ["it is a parameter of the channel"]),
    ("twice", "  kenngr.messachse 1", 3, ["already set in line "]),
    ("no value", "kenngr.probing_offset", 1, ["no value"]),
    ("two values", "kenngr.probing_offset 1 2", 25, ["more than one value", "'2'"]),
    ("unit", "kenngr.vb_messen 10 mm/s", 21, ["more than one value", "'mm/s'", "counts in um/s"]),
    ("sign", "getriebe[0].window = 7", 20, ["no `=` between", "write `getriebe[0].window 7`"]),
    ("close sign", "kenngr.messachse=1", 1, ["no `=` between", "write `kenngr.messachse 1`"]),
    ("nothing near", "antr.v_reso_num 3", 1, ["no name is near it", "axisrig params"]),
    ("number", "P-AXIS-00236 100", 1, ["the number of `getriebe[i].window`"]),
    ("short number", "p-axis-518 POS", 1, ["the number of `kenngr.measure.edge`"]),
    ("other number", "P-CHAN-00057 1", 1, ["`messtyp`, a parameter of the channel"]),
    ("no such number", "P-AXIS-99999 1", 1, ["no parameter of this number"]),
    ("below", "kenngr.probing_offset -1", 23, ["P-AXIS-00467", "0 .. 4294967295 0.1 um"]),
    ("fraction", "kenngr.probing_offset 1.5", 23, ["UNS32", "'1.5'"]),
    ("text", "kenngr.probing_offset many", 23, ["UNS32", "'many'"]),
    ("huge", f"kenngr.probing_offset {'9' * 5000}", 23, ["UNS32"]),
    ("no index", "getriebe[].kv 1", 1, ["unknown axis parameter"]),
    ("huge index", f"getriebe[{'9' * 5000}].kv 1", 1, ["unknown axis parameter"]),
    ("binary", "\0\1\2 3", 1, [r"'\x00\x01\x02'"]),
]


@pytest.mark.long
def test_every_mistake_of_a_list_is_reported_at_once(
    place: Path, axisrig: Callable[..., tuple[int, str, str]]
) -> None:
    path = place / "lists/axis-z.lst"
    path.write_text("kenngr.messache 1\nkopf.achs_nr 1\na 1\nkenngr.edge\n", encoding="utf-8")
    (place / "p.csv").write_text("case,program,rig\n1,part.nc,rig.toml\n", encoding="utf-8")
    for what in (("check", "rig.toml"), ("check", "lists/axis-z.lst"), ("check", "p.csv")):
        code, _, err = axisrig(*what)
        found = [line.partition("axis-z.lst:")[2][:4] for line in err.splitlines()]
        assert (code, found) == (2, ["1:1:", "3:1:", "4:1:"]), err
    path.write_text("".join(f"a{n} 1\n" for n in range(30)), encoding="utf-8")
    *_, last = axisrig("check", "rig.toml")[2].splitlines()
    assert last == "error: 5 further errors"


@_table("added column fragments", LISTS)
def test_list_is_rejected(
    place: Path, rejected: Reject, added: str, column: int, fragments: list[str]
) -> None:
    path = place / "lists/axis-z.lst"
    text = path.read_text(encoding="utf-8")
    path.write_text(f"{text}{added}\n", encoding="utf-8")
    line = text.count("\n") + 1
    _holds(rejected("check", "rig.toml"), f"axis-z.lst:{line}:{column}:", *fragments)


def test_list_of_another_axis(place: Path, rejected: Reject) -> None:
    shutil.copy(place / "lists/axis-x.lst", place / "lists/axis-z.lst")
    _holds(rejected("check", "rig.toml"), "axis-z.lst", "'X'", "allowed: Z")


def test_all_mistakes_of_a_rig_are_reported_at_once(place: Path, axisrig: Call) -> None:
    """Keys, values, and names that nothing has; a misspelt key is not missing as well."""
    rig = place / "rig.toml"
    text = rig.read_text(encoding="utf-8")
    for old, new in (
        ("[cycle]\n", "[cycle]\nperiod_ms = 1\n"),
        ("encoder_increments", "encoder_incs"),
        ("node = 3\n", "node = 300\n"),
        ('plant = "z"', 'plant = "zz"'),
    ):
        assert old in text
        text = text.replace(old, new, 1)
    rig.write_text(text, encoding="utf-8")
    code, _, err = axisrig("check", "rig.toml")
    assert code == 2
    errors = err.splitlines()
    assert len(errors) == 4, err
    _holds(errors[0], "unknown rig key cycle.period_ms", "did you mean period_us?")
    _holds(
        errors[1], "unknown rig key drive.servo.encoder_incs", "did you mean encoder_increments?"
    )
    _holds(errors[2], "axis.Z.node", "300")
    _holds(errors[3], "axis Z: plant names nothing in this rig", "'zz'")
    lines = [int(line.split(":")[2]) for line in errors]
    assert [text.splitlines()[line - 1].split(" ")[0] for line in lines] == [
        "period_ms", "encoder_incs", "node", "plant",
    ]  # fmt: skip


def test_what_a_misspelt_table_holds_is_not_missing_as_well(place: Path, axisrig: Call) -> None:
    rig = place / "rig.toml"
    text = rig.read_text(encoding="utf-8").replace("[plant.", "[plants.")
    rig.write_text(text, encoding="utf-8")
    code, _, err = axisrig("check", "rig.toml")
    assert (code, len(err.splitlines())) == (2, 1), err
    _holds(err, "unknown rig key plants", "did you mean plant?")


def test_lists_that_are_no_files_are_reported_together(place: Path, axisrig: Call) -> None:
    rig = place / "rig.toml"
    text = rig.read_text(encoding="utf-8").replace('.lst"', '.lts"')
    rig.write_text(text, encoding="utf-8")
    code, _, err = axisrig("check", "rig.toml")
    assert (code, len(err.splitlines())) == (2, 2), err
    _holds(err, "near it: ", ".lst")
