"""Notes on the lists of a rig, list by list and in one order; its families and programs."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest

from axisrig.bench.plan.assignment import parse_assignment
from axisrig.bench.rig.families import rig_families
from axisrig.bench.rig.programs import programs_of, started_files
from axisrig.bench.rig.reading.families import FAMILIES
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, as_written, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.text.parser import read_program

Write = Callable[..., Path]
Read = Callable[..., Settings]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"
ANOTHER = """[axis.X]
list = "lists/axis-x.lst"
segment = "can1"
node = 4
drive = "servo"
plant = "x"

[plant.x]
fmu = "AxisRig.Drives.ServoAxis"

[axis.Z]
"""
# Parameters without influence, of an axis and of the channel
UNUSED = ("kenngr.nocken_laenge 7", "kopf.mds_ident 3")
OF_CHANNEL = ("spindel[0].autom_range 1",)


def _lists(path: Path, **texts: str) -> Path:
    for name, text in texts.items():
        file = path.parent / "lists" / f"{name.replace('_', '-')}.lst"
        file.write_text(file.read_text(encoding="utf-8") + text + "\n", encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("channel", "x", "z"), [(1, 2, 0), (0, 1, 1), (1, 0, 2), (0, 0, 1), (0, 2, 2), (0, 0, 0)]
)
def test_settings_without_influence_are_counted_for_each_list(
    rig_file: Write, settings_of: Read, channel: int, x: int, z: int
) -> None:
    """A list that has none is not named; the channel comes first, then the axes of the rig."""
    path = _lists(
        rig_file(("[axis.Z]\n", ANOTHER)),
        channel="\n".join(OF_CHANNEL[:channel]),
        axis_x="\n".join(UNUSED[:x]),
        axis_z="\n".join(UNUSED[:z]),
    )
    notes = [note for note in settings_of(path).notes if "influence" in note]
    expected = []
    for name, count, file in (
        ("channel", channel, "channel.lst"), ("axis X", x, "axis-x.lst"),
        ("axis Z", z, "axis-z.lst"),
    ):  # fmt: skip
        if count:
            what = "1 setting has" if count == 1 else f"{count} settings have"
            expected.append(f"{name}: {what} no influence here ({file});")
    assert [note.partition(" `axisrig")[0] for note in notes] == expected


EVERY = (
    "1 setting does not act yet (channel.lst)",
    "axis Z: 1 setting does not act yet (axis-z.lst)",
    "2 assumptions of the rig not confirmed",
    "#TIMER of a program is passed over",
    "axis Z: 1 setting has no influence here",
    "axis Z: as listed no stop can be found",
    "tools: wz[1].radius 20000 (tools.lst:1)",
)


@pytest.mark.parametrize("left_out", [None, *range(len(EVERY))])
def test_notes_of_every_kind_stand_one_behind_the_other(
    rig_file: Write, settings_of: Read, left_out: int | None
) -> None:
    """Lists, assumptions, language, influence, stops, offsets: none takes another one away."""
    wants = [number != left_out for number in range(len(EVERY))]
    path = rig_file(
        ('title = "one axis"', 'title = "one axis"\n' + 'assumed = ["a", "b"]\n' * wants[2]),
        ("[cycle]", '[language]\npass_over = ["#TIMER"]\n\n[cycle]' if wants[3] else "[cycle]"),
        ("[channel]", '[channel]\ntools = "lists/tools.lst"'),
    )
    (path.parent / "lists" / "tools.lst").write_text("wz[1].radius 20000\n" * wants[6])
    axis = [
        "antr.sercos.mdt_offset 300" * wants[1],
        UNUSED[0] * wants[4],
        "kenngr.measure.signal FIXED_STOP" * wants[5],
    ]
    _lists(path, channel="kasto_prog_meas_trigger 1" * wants[0], axis_z="\n".join(axis))
    notes = settings_of(path).notes
    expected = [words for words, is_wanted in zip(EVERY, wants, strict=True) if is_wanted]
    assert len(notes) == len(expected)
    for note, words in zip(notes, expected, strict=True):
        assert words in note


def test_one_assumption_is_one() -> None:
    rig, files = read_rig(RIGS / "probe-z.toml")
    for count, words in ((0, None), (1, "1 assumption of"), (2, "2 assumptions of")):
        table = rig.model_copy(update={"assumed": ("x",) * count})
        notes = [note for note in read_settings(table, files, []).notes if "assum" in note]
        assert [note.startswith(words or "") for note in notes] == ([True] if count else [])


# --- families and programs ---------------------------------------------------------------------


def test_families_come_in_the_order_of_their_table_each_once() -> None:
    """CAN first, which a rig means that names nothing; not by the names of their modules."""
    modules = []
    for row in FAMILIES:
        if row.rig not in modules:
            modules.append(row.rig)
    assert modules != sorted(modules)
    found = rig_families()
    assert [type(family).__module__ for family in found] == modules
    assert found == [import_module(name).FAMILY for name in modules]


@pytest.mark.parametrize("folder", [".", "programs", "programs/of/a/cell"])
def test_programs_that_the_plc_side_starts_are_beside_that_of_the_run(
    tmp_path: Path, folder: str
) -> None:
    """Wherever the rig is: another file of the same name beside that is another program."""
    (tmp_path / folder).mkdir(parents=True, exist_ok=True)
    rig = tmp_path / "rigs" / "rig.toml"
    rig.parent.mkdir()
    base = (RIGS / "probe-z.toml").as_posix()
    rig.write_text(f'base = "{base}"\n', encoding="utf-8")
    for place, name in ((rig.parent, "wrong"), (tmp_path / folder, "right")):
        (place / "second.nc").write_text(f"%{name}\nN10 M30\n", encoding="utf-8")
    (tmp_path / folder / "first.nc").write_text("%first\nN10 M30\n", encoding="utf-8")
    cells = [(parse_assignment("plc:program_start=at=M50 file=second.nc"), as_written)]
    settings = read_settings(*read_rig(rig), cells)
    first = read_program(tmp_path / folder / "first.nc", ("Z",))
    found = programs_of(settings, first)
    assert {file: program.name for file, program in found.items()} == {
        None: "first",
        "second.nc": "right",
    }
    (tmp_path / folder / "second.nc").unlink()
    with pytest.raises(UserError, match="plc:program_start: ") as caught:
        programs_of(settings, first)
    assert (caught.value.value, caught.value.hint) == (
        "second.nc", "a file beside the program of the run",
    )  # fmt: skip


def test_a_start_without_a_file_is_that_of_the_run_again(settings_of: Read) -> None:
    cells = (
        "plc:program_start=at=reset; at=M50 file=b.nc; at=M51; at=M52 file=a.nc; at=M53 file=b.nc"
    )
    assert started_files(settings_of(RIGS / "probe-z.toml", cells)) == ("b.nc", "a.nc")
    assert started_files(settings_of(RIGS / "probe-z.toml", "plc:reset=at=M50")) == ()
