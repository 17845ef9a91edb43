"""Older names of parameters, times in cycles, and what counts where every place leaves it open."""

from pathlib import Path

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import ParameterSet, read_list
from axisrig.kernel.parameters.drive_types import DRIVE_TYPES, DriveType
from axisrig.kernel.parameters.of_drive_type import of_drive_type
from axisrig.kernel.parameters.origin import Origin
from axisrig.kernel.parameters.table import table

OLDER = [(row.path, old) for row in table("axis").parameters for old in row.old_paths]
FIXED_STOP = "kenngr.measure.fixed_stop_detect"


def allowed_text(path: str) -> str:
    """Return a value that a list may give a parameter: its first word, its default, or a name."""
    row, _ = table("axis").find(path)
    if row.values:
        return row.values[0]
    return str(int(row.default)) if row.default != "" else "A"


@pytest.mark.parametrize(("path", "old"), OLDER[::3])
def test_what_was_set_under_an_older_name_is_set_under_each(path: str, old: str) -> None:
    present, older = (name.replace("[i]", "[0]") for name in (path, old))
    text = allowed_text(present)
    for written in (present, older):
        axis = ParameterSet("axis")
        assert not axis.is_set(present)
        assert not axis.is_set(older)
        place = Origin("z.lst", 7, 3)
        axis.load(written, text, place)
        assert (axis.is_set(present), axis.is_set(older)) == (True, True)
        assert axis.origin(present) == axis.origin(older) == place
        assert axis.get(present) == axis.get(older)
        keeps = written.startswith("kenngr.distc.")  # the structure that chooses its IDs
        assert axis.list_name(present) == (written if keeps else present)


@pytest.mark.parametrize("cycle_ns", [1_000_000, 333_333, 62_500, 7])
def test_a_time_in_cycles_is_a_whole_number_of_them(cycle_ns: int) -> None:
    """Also where a cycle is no whole number of microseconds."""
    axis = ParameterSet("axis")
    axis.set("antr.nbr_delay_cycles", "3", "z.lst")
    assert axis.ns("antr.nbr_delay_cycles", cycle_ns) == 3 * cycle_ns
    axis.set("kenngr.fixed_stop_nbr_cycles", "5", "z.lst")
    assert axis.ns(f"{FIXED_STOP}.min_time", cycle_ns) == 5 * cycle_ns
    axis.set(f"{FIXED_STOP}.min_time", "40", "z.lst")
    assert axis.ns(f"{FIXED_STOP}.min_time", cycle_ns) == 40_000


@pytest.mark.parametrize(
    ("own", "other", "value", "decides"),
    [
        (None, None, 0, "own"), ("50", "70", 50, "own"), ("0", "70", 0, "own"),
        ("-1", "70", 70, "other"), ("-1", "0", 0, "other"), ("-1", "-1", 0, "own"),
    ],
)  # fmt: skip
def test_a_distance_that_all_places_leave_open_is_none(
    own: str | None, other: str | None, value: int, decides: str
) -> None:
    """Below 0 it is open; then nobody has set what counts."""
    paths = {"own": f"{FIXED_STOP}.start_distance",
             "other": "antr.fixed_stop.detect.start_distance"}  # fmt: skip
    axis = ParameterSet("axis")
    for name, text in (("own", own), ("other", other)):
        if text is not None:
            axis.load(paths[name], text, Origin("z.lst", 1 if name == "own" else 2))
    found = axis.resolve(paths["own"])
    assert (found.value, found.key) == (value, paths[decides])
    is_open = own is None or (own, other) == ("-1", "-1")
    line = None if is_open else 1 if decides == "own" else 2
    assert (None if found.origin is None else found.origin.line) == line


def test_a_path_that_only_begins_with_a_number_is_no_number() -> None:
    axis = ParameterSet("axis")
    with pytest.raises(UserError) as caught:
        axis.set("P-AXIS-00018", "1", "z.lst")
    assert "`kenngr.achs_typ`" in str(caught.value.hint)
    for path in ("P-AXIS-00018.x", "P-AXIS-000181"):
        with pytest.raises(UserError) as caught:
            axis.set(path, "1", "z.lst")
        assert "number" not in str(caught.value.hint)


@pytest.mark.parametrize("kind", [k for k in DRIVE_TYPES.values() if not k.latch])
@pytest.mark.parametrize("edge", ["POS", "NEG"])
def test_a_drive_that_latches_nothing_refuses_no_edge(kind: DriveType, edge: str) -> None:
    """The signal that counts where nobody has set one is that of a drive."""
    axis = ParameterSet("axis")
    axis.set("kenngr.measure.edge", edge, "z.lst")
    assert axis.word("kenngr.measure.signal") == "DRIVE"
    found = list(of_drive_type(axis, "Z", kind))
    assert not [alarm for alarm in found if "edge" in str(alarm)]
    assert axis.word("kenngr.measure.edge") == edge


PAIRS = [(path.replace("[i]", "[0]"), old.replace("[i]", "[0]")) for path, old in OLDER]


@pytest.mark.parametrize(("path", "old"), PAIRS[::5])
@pytest.mark.parametrize("turned", [False, True])
def test_an_older_name_and_the_present_one_are_one_parameter_of_a_list(
    tmp_path: Path, path: str, old: str, turned: bool
) -> None:
    text = allowed_text(path)
    first, second = (old, path) if turned else (path, old)
    file = tmp_path / "z.lst"
    file.write_text(f"# of Z\n{first} {text}\nkenngr.messachse 1\n{second} {text}\n", "utf-8")
    with pytest.raises(UserError) as caught:
        read_list(file, "axis")
    assert caught.value.message == "parameter is already set in line 2"
    assert (caught.value.line, caught.value.column, caught.value.value) == (4, 1, second)


@pytest.mark.parametrize("axis", [None, "X", "Z"])
@pytest.mark.parametrize("name", ["", "kopf.log_achs_name Z\n"])
def test_a_list_of_one_axis_is_that_of_any(tmp_path: Path, axis: str | None, name: str) -> None:
    """Whatever it calls the axis: the rig says whose list it is."""
    file = tmp_path / "one.lst"
    file.write_text(f"{name}kenngr.messachse 1\n", "utf-8")
    assert read_list(file, "axis", axis).flag("kenngr.messachse")
