"""What the bench says of FMUs of other tools: what they lack, and mistakes with their place.

The table and the switch are those of test_foreign_rigs.py.
"""

import re
from collections.abc import Callable
from pathlib import Path
from zipfile import ZipFile

import pandas as pd
import pytest

from axisrig.bench.cli.main import main
from axisrig.bench.judge.observed.observed import Observed
from axisrig.bench.judge.program.findings import log_lines
from axisrig.bench.judge.topics import events
from axisrig.bench.record.facts import read_run
from axisrig.bench.record.series import Series

FEED_MM_S = 500 / 60
INPUT_DELAY_S = 4e-6
INCREMENT_MM = 10 / 1_048_576

Place = Callable[..., Path]


def call(capsys: pytest.CaptureFixture[str], *words: str | Path) -> tuple[object, str, str]:
    """Call `axisrig`."""
    capsys.readouterr()
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    printed = capsys.readouterr()
    return ended.value.code, printed.out, printed.err


def test_check_tells_what_the_bench_makes_of_the_fmus(
    place: Place, capsys: pytest.CaptureFixture[str], version: int
) -> None:
    code, out, err = call(capsys, "check", place() / "rig.toml")
    assert (code, err) == (0, "")
    assert f"plant table (table.fmu, FMI {version}.0) is an axis" in out
    assert "\n  no velocity: numeric derivative of position" in out
    assert f"plant switch (switch.fmu, FMI {version}.0) is a probe" in out
    assert "\n  no rising_count, falling_count, rising_time, falling_time: edges are looked" in out


@pytest.mark.long
def test_what_a_plant_lacks_is_in_check_and_not_before_each_result(
    place: Place, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = place()
    lack = "no enabled: while the drive is off the demand stays"
    code, out, err = call(capsys, "nc", folder / "part.nc", "--rig", folder / "rig.toml")
    assert (code, out) == (0, "V.A.MERF.Z=1\n")
    assert lack not in err
    assert lack in call(capsys, "check", folder / "rig.toml")[1]


PLAN = """\
case,program,rig,check:latch_mm:Z,check:latch_error_um:Z
a,part.nc,rig.toml,<= {limit},<= 1
"""


@pytest.mark.long
def test_uncertain_edge_makes_a_verdict_at_the_limit_inconclusive(
    place: Place, capsys: pytest.CaptureFixture[str]
) -> None:
    """The true place of the latch is the limit; the edge is known to 50 us."""
    folder = place(saves=False)
    limit_mm = 100.0 - FEED_MM_S * INPUT_DELAY_S
    (folder / "plan.csv").write_text(PLAN.format(limit=f"{limit_mm:.7f}"), encoding="utf-8")
    call(capsys, "run", folder / "plan.csv", "-o", folder / "out")
    rows = pd.read_csv(folder / "out" / "results.csv").set_index("metric")
    latch = rows.loc["latch_mm:Z"]
    assert latch["verdict"] == "inconclusive"
    assert latch["uncertainty"] == pytest.approx(FEED_MM_S * 50e-6, rel=0.01)
    assert 0.0 <= limit_mm - latch["value"] <= latch["uncertainty"] + INCREMENT_MM
    facts = read_run(folder / "out" / "runs" / "plan-a.json").facts
    assert facts is not None
    log = log_lines(facts)
    assert "plant switch: edges are known to 50000 ns" in log
    assert "plant table: no velocity: numeric derivative of position" in log
    observed = Observed(facts, Series(folder / "out" / "traces" / "plan-a.parquet"))
    assert [e.label for e in events(observed) if e.kind == "edge"] == [
        "switch: rising edge, known to 50 us"
    ]
    assert "gives no contact" in rows.loc["latch_error_um:Z"]["note"]


@pytest.mark.parametrize(("behaviour", "value"), [(1, "nan"), (2, "inf")])
def test_position_that_is_no_number_is_told_with_its_variable(
    place: Place, capsys: pytest.CaptureFixture[str], behaviour: int, value: str
) -> None:
    folder = place(('"control.gain" = 40', f'"control.gain" = 40, behaviour = {behaviour}'))
    code, out, err = call(capsys, "nc", folder / "part.nc", "--rig", folder / "rig.toml")
    assert (code, out) == (2, "")
    assert re.search(rf"plant table at t = 200\.\d+ ms: table.s \(position\) is {value}", err)


def test_crash_in_a_process_apart_is_told_with_call_and_time(
    place: Place, capsys: pytest.CaptureFixture[str], version: int
) -> None:
    folder = place(('"control.gain" = 40', '"control.gain" = 40, behaviour = 4'))
    words = ("nc", folder / "part.nc", "--rig", folder / "rig.toml", "--isolate")
    code, out, err = call(capsys, *words)
    assert (code, out) == (2, "")
    answer = (
        rf"FMU table.fmu \(plant table\) crashed in fmi{version}DoStep at t = (\S+) ms: SIGABRT"
    )
    found = re.search(answer, err)
    assert found is not None, err
    # the step that leads beyond 0.2 s begins less than a drive tick before
    assert 200.0 - 0.0625 < float(found[1]) <= 200.0


@pytest.mark.long
def test_texts_and_items_of_enumerations_are_start_values_too(
    place: Place, capsys: pytest.CaptureFixture[str]
) -> None:
    """The nervous table warns of its text, which the log of the run then holds."""
    more = ('"control.gain" = 40', '"control.gain" = 40, mood = "nervous", text = "Hot Oil"')
    folder = place(more)
    _, _, err = call(capsys, "nc", folder / "part.nc", "--rig", folder / "rig.toml")
    assert re.search(r"plant table at 0\.0+ ms: Hot Oil", err)
    wrong = ('"control.gain" = 40', '"control.gain" = 40, mood = "nervus"')
    code, _, err = call(capsys, "check", place(wrong) / "rig.toml")
    assert code == 2
    assert "has no such item; found 'nervus'; did you mean: nervous" in err


def test_unit_that_nobody_defines_takes_a_bare_number_only(
    place: Place, capsys: pytest.CaptureFixture[str]
) -> None:
    bare = ('"control.gain" = 40', '"control.gain" = 40, oil = 3')
    assert call(capsys, "check", place(bare) / "rig.toml")[0] == 0
    suffixed = ('"control.gain" = 40', '"control.gain" = 40, oil_mm = 3')
    code, _, err = call(capsys, "check", place(suffixed) / "rig.toml")
    assert code == 2
    assert "is in parsec, which the FMU does not define" in err


@pytest.mark.long
@pytest.mark.parametrize("version", [2], ids=["FMI2"], indirect=True)
def test_description_that_breaks_the_standard_is_told_and_used(
    place: Place, capsys: pytest.CaptureFixture[str]
) -> None:
    """A tool has put in an attribute of its own, which the schema does not allow."""
    folder = place()
    fmu = folder / "table.fmu"
    with ZipFile(fmu) as old:
        files = {name: old.read(name) for name in old.namelist()}
    text = files["modelDescription.xml"].decode()
    text = text.replace("<CoSimulation ", '<CoSimulation colour="red" ')
    files["modelDescription.xml"] = text.encode()
    with ZipFile(fmu, "w") as new:
        for name, content in files.items():
            new.writestr(name, content)
    code, out, err = call(capsys, "check", folder / "rig.toml")
    assert (code, err) == (0, "")
    assert "its description breaks the standard (" in out
    assert "'colour'" in out
    code, out, _ = call(capsys, "nc", folder / "part.nc", "--rig", folder / "rig.toml")
    assert (code, out) == (0, "V.A.MERF.Z=1\n")


MISTAKES = [
    (
        ('position = "table.s"', 'position = "motor.phi"'),
        "position = ",
        ["motor.phi is in rad", "lead_mm"],
    ),
    (('"table.s"', '"tabel.s"'), "position = ", ["'tabel.s'", "table.s"]),
    (("z_position =", "z_posision ="), "z_posision", ["z_posision", "z_position"]),
    (('position = "table.s"\n', ""), "fmu = ", ["a plant of the kind axis needs: position"]),
    (('wire = { z = "table" }\n', ""), "[plant.switch]", ["wired to no axis"]),
    (('unit = "mm"', 'unit = "ell"'), "z_position", ["'ell'", "unknown unit"]),
    (("sign = -1", "sign = 2"), "z_position", ["z_position.sign: input should be 1 or -1"]),
    (("sign = -1", "sgn = -1"), "z_position", ["unknown rig key", "sgn", "did you mean sign?"]),
    (("threshold = 12", 'threshold = "a"'), "signal", ["threshold: must be a number"]),
    (
        ('variable = "contact_v", ', ""),
        "signal",
        ["lacks the key", "map.signal.variable"],
    ),
    (('position = "table.s"', "position = 5"), "position = ", ["must be a text", "found 5"]),
    (('position = "table.s"', 'position = ""'), "position = ", ["no such variable; found ''"]),
    (('"table.fmu"\n', '"table.fmu"\nwire = { z = "table" }\n'), "wire = ", ["is an axis"]),
    (
        ('"table.s_start_mm" = 103', '"table.s_start" = 103'),
        "start = ",
        ["is in mm", "would be a guess", "table.s_start_mm"],
    ),
    (
        ('"table.s_start_mm" = 103', '"table.s_start_mm_s" = 103'),
        "start = ",
        ["another unit", "mm_s"],
    ),
    (("trip_mm", "tripp_mm"), "start = ", ["'tripp_mm'", "did you mean: trip_mm"]),
    (('"control.gain" = 40', '"control.s_set_mm" = 40'), "start = ", ["control.s_set"]),
]


@pytest.mark.parametrize("version", [3], ids=["FMI3"], indirect=True)
@pytest.mark.parametrize(("change", "line", "fragments"), MISTAKES)
def test_mistake_in_a_map_is_told_with_its_place(
    place: Place,
    capsys: pytest.CaptureFixture[str],
    change: tuple[str, str],
    line: str,
    fragments: list[str],
) -> None:
    folder = place(change)
    code, out, err = call(capsys, "check", folder / "rig.toml")
    assert (code, out) == (2, "")
    number = int(err.split("rig.toml:")[1].split(":")[0])
    text = (folder / "rig.toml").read_text(encoding="utf-8").splitlines()[number - 1]
    assert text.startswith(line), err
    for fragment in fragments:
        assert fragment in err
