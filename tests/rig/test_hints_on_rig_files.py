"""What a rig file that cannot be read says: what a line was to be, what is near a wrong word."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.file import load_tables, read_rig
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
Read = Callable[..., Settings]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def refused(path: Path) -> UserError:
    with pytest.raises(UserError) as caught:
        read_rig(path)
    return caught.value


@pytest.mark.parametrize(
    ("line", "column", "hint"),
    [
        ("plant = z", 9, 'a text is in quotes: plant = "z"'),
        ("plant = z # the slide", 9, 'a text is in quotes: plant = "z"'),
        ('plant = z"', 9, 'a text is in quotes: plant = "z"'),
        ("kv = 4,5", 7, "a decimal point, not a comma: kv = 4.5"),
        ("kv = -4,5  # per s", 8, "a decimal point, not a comma: kv = -4.5"),
        ("kv = 4.5.6", 9, None),
        ("plant", 6, None),
    ],
)
def test_a_line_that_is_no_toml_shows_how_it_was_meant(
    rig_file: Write, line: str, column: int, hint: str | None
) -> None:
    path = rig_file(('plant = "z"\n', f"{line}\n"))
    error = refused(path)
    text = path.read_text(encoding="utf-8").splitlines()
    assert error.message.startswith("no valid TOML: ")
    assert "at line" not in error.message
    assert error.line == text.index(line) + 1
    assert error.column == column
    assert error.hint == hint


@pytest.mark.parametrize("value", ["true", "false"])
def test_a_key_that_is_there_twice_is_no_text_without_quotes(rig_file: Write, value: str) -> None:
    twice = f"outside = {value}\n"
    error = refused(rig_file(('plant = "z"\n', f'plant = "z"\n{twice}{twice}')))
    assert error.hint is None
    assert error.line is not None


@pytest.mark.parametrize(
    ("old", "key", "wrong", "near"),
    [
        ("bitrate = 1_000_000", "carrier", "ethercatt", "ethercat"),
        ("bitrate = 1_000_000", "carrier", "cyclc", "cyclic"),
        ("lead_mm = 10.0", "family", "sercoss", "sercos"),
        ("lead_mm = 10.0", "family", "profdrive", "profidrive"),
    ],
)
def test_a_word_that_is_near_one_of_the_table_is_shown_that_alone(
    rig_file: Write, old: str, key: str, wrong: str, near: str
) -> None:
    error = refused(rig_file((old, f'{key} = "{wrong}"\n{old}')))
    assert error.message.endswith(f"there is no such {key}; allowed: {near}")
    assert error.value == wrong


def test_a_word_that_is_near_none_is_shown_all_each_once(rig_file: Write) -> None:
    error = refused(rig_file(("lead_mm = 10.0", 'family = "xyzzy"\nlead_mm = 10.0')))
    words = error.message.rpartition("allowed: ")[2].split(", ")
    assert words == [
        "canopen", "sercos", "profidrive", "encoder_terminal", "lightbus", "conventional",
    ]  # fmt: skip


# --- bases -------------------------------------------------------------------------------------


def write(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def test_each_base_is_looked_for_beside_the_file_that_names_it(tmp_path: Path) -> None:
    """Three folders; the lists of each are beside it too."""
    write(tmp_path / "c/low.toml", '[channel]\nlist = "own.lst"\n[cycle]\nperiod_us = 4000\n')
    middle = 'base = "../c/low.toml"\n[axis.Z]\nlist = "z.lst"\n[cycle]\nfine_us = 20\n'
    write(tmp_path / "b/middle.toml", middle)
    top = write(tmp_path / "a/top.toml", 'base = "../b/middle.toml"\ntitle = "x"\n')
    table, files = load_tables(top)
    assert [file.relative_to(tmp_path.resolve()).as_posix() for file in files] == [
        "a/top.toml", "b/middle.toml", "c/low.toml",
    ]  # fmt: skip
    assert table["channel"]["list"] == str((tmp_path / "c/own.lst").resolve())
    assert table["axis"]["Z"]["list"] == str((tmp_path / "b/z.lst").resolve())
    assert table["cycle"] == {"period_us": 4000, "fine_us": 20}
    assert "base" not in table


@pytest.mark.parametrize("length", [1, 2, 3, 4])
@pytest.mark.parametrize("into", [0, 1])
def test_a_circle_of_bases_is_refused_wherever_it_closes(
    tmp_path: Path, length: int, into: int
) -> None:
    """One that the first file is no part of ends at the first that comes again."""
    names = [f"{number}.toml" for number in range(length + into)]
    for name, base in zip(
        names, [*names[1:], names[into] if into < len(names) else names[0]], strict=True
    ):
        write(tmp_path / name, f'base = "{base}"\n')
    with pytest.raises(UserError, match="in a circle") as caught:
        load_tables((tmp_path / names[0]).resolve())
    assert caught.value.file == str((tmp_path / names[into]).resolve())


# --- wiring ------------------------------------------------------------------------------------


def of_check(settings: Settings) -> UserError:
    with pytest.raises(UserError) as caught:
        check_rig(settings)
    return caught.value


def test_a_drive_that_names_no_family_is_told_what_carries_the_one_it_is(
    rig_file: Write, settings_of: Read
) -> None:
    path = rig_file(("bitrate = 1_000_000", 'carrier = "cyclic"'), ("node = 3\n", ""))
    error = of_check(settings_of(path))
    assert "segment can1 (carrier cyclic) does not carry drives of the family canopen" in str(error)
    assert ", which drive servo is as it names no family" in str(error)
    assert (error.value, error.allowed) == ("cyclic", "can, ethercat")


@pytest.mark.parametrize(("named", "fits"), [("Z", True), ("z", False), ("ZZ", False)])
def test_the_name_in_a_list_is_that_of_its_axis_letter_by_letter(
    rig_file: Write, settings_of: Read, tmp_path: Path, named: str, fits: bool
) -> None:
    (tmp_path / "lists" / "axis-z.lst").write_text(f"kopf.log_achs_name {named}\n")
    settings = settings_of(rig_file())
    if fits:
        check_rig(settings)
        return
    error = of_check(settings)
    assert (error.value, error.allowed) == (named, "Z")


def test_a_plc_program_that_is_no_file_is_named_with_what_is_near_it(
    tmp_path: Path, settings_of: Read
) -> None:
    write(tmp_path / "plc/signals.py", "")
    base = (RIGS / "plc-timestamp.toml").as_posix()
    path = write(tmp_path / "rig.toml", f'base = "{base}"\n[plc]\nprogram = "plc/signal.py"\n')
    error = of_check(settings_of(path))
    assert error.message == "the PLC program is no file"
    assert error.value == str(tmp_path.resolve() / "plc/signal.py")
    assert error.hint == "near it: signals.py"
    assert (error.file, error.line) == (str(path.resolve()), 3)
