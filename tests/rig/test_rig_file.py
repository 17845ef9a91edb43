"""Rig files: what is accepted, and what every mistake says."""

from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.reading.file import MapTable, read_rig, rig_error
from axisrig.kernel.distance import Derivative, DerivativeOf, DistanceLaw, StepLimiter
from axisrig.kernel.errors import UserError

Write = Callable[..., Path]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


def _refused(path: Path) -> UserError:
    with pytest.raises(UserError) as caught:
        read_rig(path)
    return caught.value


def _line(path: Path, text: str) -> int:
    """The line of the file that holds `text`, counted here."""
    return 1 + next(n for n, line in enumerate(path.read_text().splitlines()) if text in line)


# Accepted


def test_a_rig_is_read_with_its_defaults(rig_file: Write) -> None:
    path = rig_file()
    rig, files = read_rig(path)
    assert files == [path.resolve()]
    assert (rig.cycle.period_us, rig.cycle.cycle_offset_us) == (1000, 600)
    assert (rig.cycle.exchange_us, rig.cycle.fine_us, rig.cycle.buffer_cycles) == (20_000, 50, 0)
    drive = rig.drive["servo"]
    assert (drive.encoder_increments, drive.input_delay_us, drive.latch) == (
        1_048_576,
        4.0,
        "interpolated",
    )
    assert (rig.axis["Z"].probe_1, rig.axis["Z"].probe_2) == ("probe", None)
    assert rig.plant["z"].start == {"position_start_mm": 130, "kv": 40}
    assert rig.plant["probe"].wire == {"z": "z"}


CYCLE = "[cycle]"


def test_a_rig_chooses_the_law_of_distance_control(rig_file: Write) -> None:
    """Each key by itself; what is not given is the usual one."""
    usual = read_rig(rig_file())[0].distance.law
    assert usual == DistanceLaw()
    for key, word, law in (
        ("derivative_of", "error", DistanceLaw(derivative_of=DerivativeOf.ERROR)),
        ("limiter", "clamp", DistanceLaw(limiter=StepLimiter.CLAMP)),
        ("derivative", "per_cycle", DistanceLaw(derivative=Derivative.PER_CYCLE)),
    ):
        path = rig_file((CYCLE, f'[distance]\n{key} = "{word}"\n{CYCLE}'))
        assert read_rig(path)[0].distance.law == law
        assert law != usual


def test_a_law_that_there_is_not_is_refused_with_those_there_are(rig_file: Write) -> None:
    path = rig_file((CYCLE, f'[distance]\nlimiter = "ramp"\n{CYCLE}'))
    error = _refused(path)
    assert error.line == _line(path, "ramp")
    assert (error.value, "'slope' or 'clamp'" in error.message) == ("ramp", True)
    path = rig_file((CYCLE, f"[distance]\nlimit = 1\n{CYCLE}"))
    assert "did you mean limiter?" in str(_refused(path))


def test_a_byte_order_mark_is_no_part_of_the_rig(rig_file: Write) -> None:
    path = rig_file()
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert read_rig(path)[0].title == "one axis"


def test_lists_and_fmus_are_relative_to_the_file_that_names_them(
    rig_file: Write, tmp_path: Path
) -> None:
    rig_file(('fmu = "AxisRig.Drives.ServoAxis"', 'fmu = "models/own.fmu"'))
    above = tmp_path / "night" / "above.toml"
    above.parent.mkdir()
    above.write_text('base = "../rig.toml"\ntitle = "at night"\n[plant.probe]\nfmu = "probe.fmu"\n')
    rig, files = read_rig(above)
    base = tmp_path.resolve()
    assert files == [base / "night" / "above.toml", base / "rig.toml"]
    assert rig.channel.list == str(base / "lists" / "channel.lst")
    assert rig.axis["Z"].list == str(base / "lists" / "axis-z.lst")
    assert rig.plant["z"].fmu == str(base / "models" / "own.fmu")
    assert rig.plant["probe"].fmu == str(base / "night" / "probe.fmu")


def test_the_name_of_a_model_is_no_path(rig_file: Write) -> None:
    assert read_rig(rig_file())[0].plant["z"].fmu == "AxisRig.Drives.ServoAxis"


# Base


def test_a_base_is_changed_key_by_key(rig_file: Write, tmp_path: Path) -> None:
    rig_file()
    above = tmp_path / "above.toml"
    above.write_text(
        'base = "rig.toml"\n[drive.servo]\ninput_filter_us = 250.0\n'
        "[plant.z]\nstart = { kv = 25 }\n[segment.can2]\nbitrate = 500_000\n"
    )
    rig, _ = read_rig(above)
    assert rig.title == "one axis"
    assert (rig.drive["servo"].lead_mm, rig.drive["servo"].input_filter_us) == (10.0, 250.0)
    assert rig.plant["z"].start == {"position_start_mm": 130, "kv": 25}
    assert {name: s.bitrate for name, s in rig.segment.items()} == {
        "can1": 1_000_000,
        "can2": 500_000,
    }


def test_variable_of_a_role_is_replaced_with_all_that_belongs_to_it(
    rig_file: Callable[..., Path], tmp_path: Path
) -> None:
    entry = 'map = { position = { variable = "a", sign = -1, unit = "mm" } }\n'
    rig_file(("[plant.probe]\n", entry + "[plant.probe]\n"))
    above = tmp_path / "above.toml"
    above.write_text(
        'base = "rig.toml"\n[plant.z.map]\nposition = { variable = "b" }\n', encoding="utf-8"
    )
    assert read_rig(above)[0].plant["z"].map == {"position": MapTable(variable="b")}


def test_bases_stack_and_the_nearest_file_wins(rig_file: Write, tmp_path: Path) -> None:
    rig_file()
    (tmp_path / "b.toml").write_text('base = "rig.toml"\ntitle = "b"\n[axis.Z]\nnode = 7\n')
    (tmp_path / "c.toml").write_text('base = "b.toml"\ntitle = "c"\n')
    rig, files = read_rig(tmp_path / "c.toml")
    assert (rig.title, rig.axis["Z"].node) == ("c", 7)
    assert [file.name for file in files] == ["c.toml", "b.toml", "rig.toml"]


@pytest.mark.parametrize("length", [1, 2, 3])
def test_a_circle_of_bases_is_refused(tmp_path: Path, length: int) -> None:
    for number in range(length):
        following = (number + 1) % length
        (tmp_path / f"{number}.toml").write_text(f'base = "{following}.toml"\n')
    assert "circle" in _refused(tmp_path / "0.toml").message


def test_a_mistake_in_the_base_is_told_of_the_base(rig_file: Write, tmp_path: Path) -> None:
    base = rig_file(("node = 3", "node = 200"))
    above = tmp_path / "above.toml"
    above.write_text('base = "rig.toml"\n[axis.Z]\nprobe_2 = "probe"\n')
    error = _refused(above)
    assert (error.file, error.line) == (str(base.resolve()), _line(base, "node = 200"))
    assert error.value == 200


def test_a_base_that_is_no_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text("base = 3\n")
    error = _refused(path)
    assert "base" in error.message
    assert error.value == 3


def test_a_missing_base_is_named(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text('base = "gone.toml"\n')
    error = _refused(path)
    assert error.file is not None
    assert error.file.endswith("gone.toml")


# Form


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    error = _refused(tmp_path / "none.toml")
    assert "not found" in error.message
    assert error.file is not None
    assert error.file.endswith("none.toml")


@pytest.mark.parametrize("text", ["", "\n  \n"])
def test_an_empty_file_says_so(tmp_path: Path, text: str) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(text)
    error = _refused(path)
    assert "empty" in error.message
    assert error.hint is not None
    assert "docs/rigs.md" in error.hint


@pytest.mark.parametrize(
    ("old", "new", "line_of", "column"),
    [
        ("node = 3", "node 3", "node 3", 6),
        ("node = 3", "node = ", "node = ", 8),
        ("[axis.Z]", "[axis.Z", "[axis.Z", 8),
        ("node = 3", "node = 3\nnode = 4", "node = 4", 9),
    ],
)
def test_bad_toml_is_told_with_line_and_column(
    rig_file: Write, old: str, new: str, line_of: str, column: int
) -> None:
    path = rig_file((old, new))
    error = _refused(path)
    assert "TOML" in error.message
    assert "at line" not in error.message
    assert (error.line, error.column) == (_line(path, line_of), column)


def test_a_file_in_another_encoding_is_refused(rig_file: Write) -> None:
    path = rig_file()
    path.write_bytes(path.read_bytes().replace(b"one axis", "Prüfstand".encode("latin-1")))
    assert _refused(path).file == str(path.resolve())


# Keys


@pytest.mark.parametrize(
    ("old", "new", "key", "near"),
    [
        ("node = 3", "node = 3\nprobe_3 = 1", "axis.Z.probe_3", "probe_"),
        ("lead_mm = 10.0", "leed_mm = 10.0", "drive.servo.leed_mm", "lead_mm"),
        ("cycle_offset_us = 600", "cycle_ofset_us = 600", "cycle.cycle_ofset_us", "cycle_offset"),
        ("bitrate = 1_000_000", "bit_rate = 1_000_000", "segment.can1.bit_rate", "bitrate"),
        ('wire = { z = "z" }', 'wires = { z = "z" }', "plant.probe.wires", "wire"),
        ('title = "one axis"', 'title = "x"\nbsae = "y"', "bsae", "base"),
        ("[drive.servo]", "[drives]\n[drive.servo]", "drives", "drive"),
    ],
)
def test_an_unknown_key_is_told_with_the_nearest_and_its_line(
    rig_file: Write, old: str, new: str, key: str, near: str
) -> None:
    path = rig_file((old, new))
    error = _refused(path)
    assert error.message == f"unknown rig key {key}"
    assert error.hint is not None
    assert near in error.hint
    assert error.line == _line(path, key.rpartition(".")[2])


def test_an_unknown_kind_of_table_is_told_with_its_line(rig_file: Write) -> None:
    path = rig_file(("[drive.servo]", "[drives.servo]\n[drive.servo]"))
    error = _refused(path)
    assert error.message == "unknown rig key drives"
    assert error.line == _line(path, "[drives.servo]")


def test_a_key_like_no_other_is_told_with_all_that_may_stand_there(rig_file: Write) -> None:
    error = _refused(rig_file(("node = 3", "node = 3\nqqqqqq = 1")))
    assert error.hint is None
    assert error.allowed == (
        "list, segment, node, drive, plant, probe_1, probe_2, limit_negative, limit_positive,"
        " home_switch, encoder_2, outside, sensor_age_limit_ms, accept"
    )


@pytest.mark.parametrize(
    ("old", "key", "header"),
    [
        ("node = 3\n", "axis.Z.node", "[axis.Z]"),
        ('title = "one axis"\n', "title", None),
        ('fmu = "AxisRig.Drives.ServoAxis"\n', "plant.z.fmu", "[plant.z]"),
        ('list = "lists/channel.lst"\n', "channel.list", "[channel]"),
    ],
)
def test_a_missing_key_is_told_with_its_table(
    rig_file: Write, old: str, key: str, header: str | None
) -> None:
    path = rig_file((old, ""))
    error = _refused(path)
    assert error.message == f"the rig lacks the key {key}"
    assert error.line == (None if header is None else _line(path, header))


def test_a_misspelt_required_key_is_told_as_misspelt(rig_file: Write) -> None:
    path = rig_file(("node = 3", "nod = 3"))
    error = _refused(path)
    assert error.line == _line(path, "nod = 3")
    assert "nod" in str(error)
    assert "did you mean node?" in str(error)


@pytest.mark.parametrize(
    ("old", "new", "value"),
    [
        ("node = 3", 'node = "3"', "3"),
        ("node = 3", "node = 3.5", 3.5),
        ("node = 3", "node = 0", 0),
        ("node = 3", "node = 128", 128),
        ("lead_mm = 10.0", "lead_mm = 0.0", 0.0),
        ("lead_mm = 10.0", "lead_mm = true", True),
        ("lead_mm = 10.0", 'latch = "guessed"', "guessed"),
        ("lead_mm = 10.0", "input_delay_us = -1.0", -1.0),
        ("bitrate = 1_000_000", "bitrate = 300_000", 300_000),
        ("bitrate = 1_000_000", 'interface = "socketkan"', "socketkan"),
        ("cycle_offset_us = 600", "period_us = 100", 100),
        ("cycle_offset_us = 600", "buffer_cycles = -1", -1),
        ('segment = "can1"', 'segment = "can 1"', "can 1"),
    ],
)
def test_a_wrong_value_is_told_with_its_line(
    rig_file: Write, old: str, new: str, value: object
) -> None:
    path = rig_file((old, new))
    error = _refused(path)
    assert error.value == value
    assert error.line == _line(path, new)
    assert new.partition(" ")[0] in error.message


@pytest.mark.parametrize("key", ["lead_mm", "sample_us", "input_delay_us", "input_filter_us"])
def test_not_a_number_is_refused(rig_file: Write, key: str) -> None:
    assert key in _refused(rig_file(("lead_mm = 10.0", f"{key} = nan"))).message


@pytest.mark.parametrize("key", ["lead_mm", "sample_us", "input_delay_us", "input_filter_us"])
def test_an_infinite_number_is_refused(rig_file: Write, key: str) -> None:
    _refused(rig_file(("lead_mm = 10.0", f"{key} = inf")))


def test_a_name_that_cannot_be_written_in_a_column_is_refused(rig_file: Write) -> None:
    path = rig_file(("[segment.can1]", '[segment."can-1"]'))
    error = _refused(path)
    assert "can-1" in error.message
    assert error.line == _line(path, "can-1")


def test_errors_beyond_the_form_find_keys_however_they_are_written(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_text(
        'axis.Z.node = 3\n[ drive . "servo" ] # main\n  lead_mm = 5.0\n[plant.z.start]\n'
    )
    for keys, line in [
        (("drive", "servo", "lead_mm"), 3),
        (("drive", "servo", "latch"), 2),
        (("plant", "z", "start"), 4),
        (("axis", "Z", "node"), 1),
        (("cycle", "period_us"), None),
    ]:
        error = rig_error([path], keys, "wrong")
        assert (error.file, error.line) == (str(path), line)


@pytest.mark.parametrize("path", sorted(RIGS.glob("*.toml")), ids=lambda path: path.name)
def test_shipped_rigs_are_read(path: Path) -> None:
    rig, files = read_rig(path)
    assert rig.title
    assert files[0] == path.resolve()


@pytest.mark.parametrize(
    ("new", "named"),
    [
        # A wrong key that may be the missing one is named alone; `prob_1` is near to `probe_1`
        ("plamt = 3\n", ["axis.Z.plamt"]),
        ("qqqq = 3\n", ["axis.Z.qqqq"]),
        ("prob_1 = 3\n", ["axis.Z.prob_1", "the rig lacks the key axis.Z.plant"]),
        ("", ["the rig lacks the key axis.Z.plant"]),
    ],
)
def test_a_missing_key_is_named_beside_one_that_is_misspelt_for_another(
    rig_file: Write, new: str, named: list[str]
) -> None:
    """A key without any likeness may be meant for the one that is missing in the same table."""
    probe = () if "prob_1" not in new else (('probe_1 = "probe"\n', ""),)
    error = _refused(rig_file(('plant = "z"\n', new), *probe))
    found = [error.message, *(one.message for one in error.further)]
    assert {one.removeprefix("unknown rig key ") for one in found} == {*named}
    assert len(found) == len(named)
