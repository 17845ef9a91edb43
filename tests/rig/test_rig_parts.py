"""Parts of what a rig is read from: its files, foreign FMUs, lists read once, places of faults."""

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from pydantic import ValidationError

from axisrig.bench.rig import contents
from axisrig.bench.rig.contents import contents_text
from axisrig.bench.rig.reading import families, file, foreign
from axisrig.bench.rig.reading.faults import (
    TERMINAL_TELEGRAMS,
    fault_keys,
    fault_kinds,
    fault_moments,
    faults_table,
    read_faults,
)
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.reading.foreign import foreign_plants, foreign_rigs
from axisrig.bench.rig.reading.lists import offset_notes, stop_notes
from axisrig.bench.rig.reading.once import read_once
from axisrig.bench.rig.reading.sources import rig_files
from axisrig.bench.rig.settings import Settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.nc.coordinates.tables import Lists
from axisrig.kernel.parameters import Origin, ParameterSet

Write = Callable[..., Path]
Read = Callable[..., Settings]
RIGS = Path(__file__).parents[2] / "testplans" / "rigs"


# Its files


def test_every_file_that_a_rig_is_made_from_counts(tmp_path: Path) -> None:
    """Of a model those beside and below it, which it may use; a name of the library is no file."""
    names = (
        "lists/c.lst", "lists/z.lst", "lists/offsets.lst", "lists/tools.lst", "d.eds", "d.csv",
        "p.py", "a.fmu", "models/own.mo", "models/part.mo", "models/deep/part.mo",
        "models/notes.txt", "other/unused.mo",
    )  # fmt: skip
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    (tmp_path / "base.toml").write_text(
        '[channel]\nlist = "lists/c.lst"\nzero_offsets = "lists/offsets.lst"\n'
        'tools = "lists/tools.lst"\n[axis.Z]\nlist = "lists/z.lst"\n'
        '[drive.servo]\neds = "d.eds"\npdo_map = "d.csv"\n[drive.plain]\npdo_map = "generic"\n',
        encoding="utf-8",
    )
    (tmp_path / "sub").mkdir()
    rig = tmp_path / "sub" / "rig.toml"
    rig.write_text(
        'base = "../base.toml"\n[plc]\nperiod_us = 1000\nprogram = "../p.py"\n'
        '[plant.a]\nfmu = "../a.fmu"\n[plant.b]\nfmu = "../models/own.mo"\n'
        '[plant.c]\nfmu = "AxisRig.Drives.ServoAxis"\n',
        encoding="utf-8",
    )
    found = rig_files(rig)
    assert found[:2] == [rig, tmp_path / "base.toml"]
    own = [path for path in found[2:] if path.name != "generic"]
    expected = [tmp_path / name for name in names if "notes" not in name and "other" not in name]
    assert own == sorted(expected)
    (tmp_path / "models" / "own.mo").unlink()
    assert tmp_path / "models" / "part.mo" not in rig_files(rig)  # a model that is missing has none


def test_an_fmu_that_was_not_built_here_is_foreign(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(foreign, "is_ours", lambda path: path.name == "ours.fmu")
    fmus = {"z": "/x/theirs.fmu", "y": "/x/ours.fmu", "x": "AxisRig.Drives.ServoAxis",
            "w": "/y/theirs.fmu", "v": "/x/model.mo", "u": "/x/theirs.fmu"}  # fmt: skip
    plants: Any = {name: SimpleNamespace(fmu=fmu) for name, fmu in fmus.items()}
    assert foreign_plants(plants) == ["z", "w", "u"]
    rigs = {name: tmp_path / f"{name}.toml" for name in ("theirs", "ours", "broken", "missing")}
    known = {rigs["theirs"]: plants, rigs["ours"]: {"y": plants["y"]}}

    def read(path: Path) -> Any:
        if path == rigs["missing"]:
            raise FileNotFoundError
        if path == rigs["broken"]:
            raise UserError("no rig")
        return SimpleNamespace(plant=known[path]), []

    monkeypatch.setattr(foreign, "read_rig", read)
    assert foreign_rigs(rigs.values()) == {rigs["theirs"]}
    assert foreign_rigs([]) == set()


def test_a_list_is_read_anew_where_its_content_changed_and_nobody_shares_it(
    tmp_path: Path,
) -> None:
    path = tmp_path / "z.lst"
    path.write_text("kopf.log_achs_name Z\nkopf.achs_nr 3\n", encoding="utf-8")
    first, second = read_once(path, "axis", "Z"), read_once(path, "axis", "Z")
    first.load("kopf.achs_nr", "7", Origin("own.lst", 1))
    assert (first.integer("kopf.achs_nr"), second.integer("kopf.achs_nr")) == (7, 3)
    assert read_once(path, "axis", "Z").integer("kopf.achs_nr") == 3
    path.write_text("kopf.log_achs_name Z\nkopf.achs_nr 4\n", encoding="utf-8")
    assert read_once(path, "axis", "Z").integer("kopf.achs_nr") == 4
    with pytest.raises(UserError) as caught:
        read_once(tmp_path / "none.lst", "axis", "Z")
    assert "none.lst" in str(caught.value)


# What lists say that cannot be meant


def axis(**values: int) -> ParameterSet:
    found = ParameterSet("axis")
    for name, value in values.items():
        path = "kenngr.measure." + name.replace("__", ".")
        found.load(path, str(value) if name != "signal" else "FIXED_STOP", Origin("z.lst", 1))
    return found


STOP = "fixed_stop_detect__"


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, None),  # another source
        ({"signal": 1}, "set a lag limit (P-AXIS-00774"),
        ({"signal": 1, STOP + "pos_lag_limit": 5000}, None),
        ({"signal": 1, STOP + "max_delta_position_window": 1500}, "no minimum time: set min_time"),
        ({"signal": 1, STOP + "max_delta_position_window": 1500, STOP + "min_time": 20_000}, None),
        ({STOP + "max_delta_position_window": 1500}, None),
    ],
)
def test_a_stop_that_nothing_can_find_is_said(values: dict[str, int], words: str | None) -> None:
    notes = stop_notes({"X": axis(), "Z": axis(**values)})
    if words is None:
        assert notes == []
        return
    (note,) = notes
    assert note.startswith("axis Z: as listed no stop can be found")
    assert words in note


def offsets(tmp_path: Path, name: str, *lines: str) -> Lists:
    path = tmp_path / f"{name}.lst"
    path.write_text("\n".join(["# a list", *lines, ""]), encoding="utf-8")
    lists = Lists()
    lists.read(name, path)
    return lists


@pytest.mark.parametrize(
    ("lines", "notes"),
    [
        (["wz[2].gueltig 1", "wz[2].radius 0", "wz[2].laenge 800000"], []),
        (["wz[2].gueltig 1", "wz[2].radius -1"], ["a radius below 0"]),
        (["wz[2].laenge 800000"], ["the list has no `wz[2].gueltig 1`, so D2 is refused"]),
        (["wz[2].gueltig 0", "wz[2].laenge 1"], ["no `wz[2].gueltig 1`"]),
        (["wz[2].laenge 1", "wz[2].radius 5"], ["no `wz[2].gueltig 1`"]),  # once for each tool
        (["wz[2].laenge 1", "wz[3].laenge 1", "wz[3].gueltig 1"], ["no `wz[2].gueltig 1`"]),
        (["wz[0].gueltig 1"], ["D0 is no tool, its data never act"]),
        (["wz[2].gueltig 1", "wz[2].ax_versatz[1] 10"], []),
        (["wz[2].gueltig 1", "wz[2].ax_versatz[2] 10"], ["the rig has no axis 2, it has 0 = X"]),
    ],
)
def test_what_cannot_be_meant_in_a_list_of_tools_is_said(
    tmp_path: Path, lines: list[str], notes: list[str]
) -> None:
    found = offset_notes(offsets(tmp_path, "tools", *lines), ("X", "Z"))
    assert len(found) == len(notes), found
    for note, words in zip(found, notes, strict=True):
        assert note.startswith("tools: wz[")
        assert words in note
    beside = offset_notes(offsets(tmp_path, "tools", "wz[2].gueltig 1", "wz[2].ax_versatz[7] 1"))
    assert beside == []  # without a rig nobody knows its axes


# Places of faults


def allowed(rig: str, kind: str) -> set[str]:
    with pytest.raises(UserError) as caught:
        read_faults(kind, "nowhere", read_rig(RIGS / rig)[0])
    return set((caught.value.allowed or "").split(", "))


PLACES = {
    # rig: signal, sensor, plc, terminal; telegrams of a terminal
    "probe-xyz.toml": ("probe", "", "", "", False),
    "plc-drive-input.toml": ("probe", "", "plc", "", False),
    "plc-io-node.toml": ("probe", "", "plc", "", True),  # a node on CAN has no stamps
    "plc-timestamp.toml": ("probe", "", "plc", "terminal", False),
    "distance-xz.toml": ("", "gap", "", "", False),
    "distance-z-variable.toml": ("", "gap", "", "", False),
}


@pytest.mark.parametrize("rig", PLACES)
def test_a_fault_has_the_places_that_a_rig_has(rig: str) -> None:
    *own, has_node = PLACES[rig]
    kinds = ("probe_stick", "sensor_drift", "plc_lost", "clock_off")
    assert [", ".join(sorted(allowed(rig, kind))) for kind in kinds] == own
    axes = set(read_rig(RIGS / rig)[0].axis)
    buses = set(read_rig(RIGS / rig)[0].segment)
    assert (allowed(rig, "reset"), allowed(rig, "babble")) == (axes, buses)
    assert allowed(rig, "sync_loss") == axes | buses
    telegrams = allowed(rig, "drop")
    assert telegrams >= {f"{axis}.EMCY" for axis in axes} | {f"{bus}.SYNC" for bus in buses}
    assert (telegrams >= {f"terminal.{name}" for name in TERMINAL_TELEGRAMS}) is has_node


def test_a_fault_knows_axis_and_bus_of_its_place() -> None:
    for rig, kind, target, place in (
        ("plc-io-node.toml", "drop", "terminal.TPDO1", ("", "can1", "TPDO1")),
        ("plc-io-node.toml", "drop", "can1.SYNC", ("", "can1", "SYNC")),
        ("plc-io-node.toml", "drop", "Z.RPDO1", ("Z", "", "RPDO1")),
        ("probe-xyz.toml", "babble", "can2", ("", "can2", "")),
        ("plc-timestamp.toml", "clock_off", "terminal", ("", "", "")),
        ("plc-timestamp.toml", "probe_stick", "probe", ("", "", "")),
    ):
        (fault,) = read_faults(kind, target, read_rig(RIGS / rig)[0])
        assert (fault.axis, fault.segment, fault.telegram) == place, target


# Keys that are written wrong


@pytest.mark.parametrize(
    ("text", "near", "others"),
    [
        ("[plant.z.map.position]\nvariabel = 'x'\n", "variable", {"sign", "threshold"}),
        ("[plc]\nperiod_us = 1000\nprogramm = 'p.py'\n", "program", {"busy_us", "task"}),
        (
            "[plc]\nperiod_us = 1000\nprogram = 'p.py'\n[plc.terminal]\nstamp_edgy = 'last'\n",
            "stamp_edge", {"node", "filter_us"},
        ),
        ('[plc]\n"V.E.S" = { sensor = "z", delay_cycle = 1 }\n', "delay_cycles", {"sign"}),
        ("[distance]\nlimitr = 'slope'\n", "limiter", {"derivative_of"}),
    ],
)  # fmt: skip
def test_a_key_that_is_written_wrong_is_named_with_those_of_its_table(
    rig_file: Write, text: str, near: str, others: set[str]
) -> None:
    path = rig_file()
    path.write_text(path.read_text(encoding="utf-8") + text, encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_rig(path)
    error = caught.value
    assert error.message.startswith("unknown rig key ")
    assert error.hint == f"did you mean {near}?"
    assert set((error.allowed or "").split(", ")) >= {near, *others}
    assert error.line is not None
    line = path.read_text(encoding="utf-8").splitlines()[error.line - 1]
    assert near[:5] in line


def test_a_sync_counter_begins_at_2(rig_file: Write) -> None:
    for value, is_good in ((0, True), (1, False), (2, True), (240, True), (241, False)):
        path = rig_file(("[cycle]", f"[cycle]\nsync_counter = {value}"))
        if is_good:
            assert read_rig(path)[0].cycle.sync_counter == value
        else:
            with pytest.raises(UserError, match=r"cycle\.sync_counter"):
                read_rig(path)


def test_a_number_of_a_rig_is_finite(rig_file: Write) -> None:
    for word in ("nan", "inf", "-inf"):
        path = rig_file(("[cycle]", f"[realtime]\nlate_us = {word}\n[cycle]"))
        with pytest.raises(UserError, match=r"late_us: must be a finite number"):
            read_rig(path)


def test_a_terminal_that_a_rig_does_not_have_cannot_be_changed(
    rig_file: Write, settings_of: Read
) -> None:
    without = rig_file()
    with pytest.raises(UserError, match="the rig has no PLC task"):
        settings_of(without, "plc:terminal.filter_us=5")
    settings = settings_of(RIGS / "plc-timestamp.toml", "plc:terminal.filter_us=5")
    task = settings.rig.plc_task
    assert task is not None
    assert task.terminal is not None
    assert task.terminal.filter_us == 5
    text = (RIGS / "plc-drive-input.toml").read_text(encoding="utf-8")
    assert "terminal" not in text.partition("[")[2]
    with pytest.raises(UserError, match="the PLC of this rig has no terminal"):
        settings_of(RIGS / "plc-drive-input.toml", "plc:terminal.filter_us=5")


# What a list says, as text


def test_a_list_of_tools_is_told_in_mm_where_it_is_not_in_inch(tmp_path: Path) -> None:
    """0.1 um; of a tool in inch only what is written."""
    path = tmp_path / "tools.lst"
    path.write_text(
        "wz[2].gueltig 1\nwz[2].laenge 800000\nwz[3].gueltig 1\nwz[3].mass_einheit 1\n"
        "wz[3].laenge 10000\nwz[4].laenge 5\n",
        encoding="utf-8",
    )
    lines = [line.strip() for line in contents_text(path).splitlines() if line.strip()]
    assert lines[0] == "tools"
    assert "wz[2].laenge 800000 x 0.1 um = 80 mm  tools.lst:2" in lines
    assert any(line.startswith("wz[3].laenge 10000  ") for line in lines)
    assert "wz[2].gueltig 1  tools.lst:1" in lines
    assert lines[-1].startswith("note: tools: wz[4].laenge 5 (tools.lst:6): the list has no")


def test_values_of_a_rig_are_chosen_by_all_words_or_by_one_parameter() -> None:
    settings = contents.settings_of(RIGS / "probe-z.toml", ["set:Z.getriebe[0].vb_eilgang=77000"])
    parts = contents.parts_of(settings, None)
    assert list(parts) == ["channel", "Z"]
    assert list(contents.parts_of(settings, "Z")) == ["Z"]
    with pytest.raises(UserError, match="the rig has no such axis"):
        contents.parts_of(settings, "Q")
    (one,) = contents.blocks_text(parts, ["P-AXIS-00209"])
    title, line = one.splitlines()
    assert title == "axis Z"
    assert "vb_eilgang" in line
    assert "77000" in line
    both = "\n".join(contents.blocks_text(parts, ["p-axis-00209", "rapid"]))
    assert "vb_eilgang" in both
    assert contents.blocks_text(parts, ["rapid", "zebra"]) == []
    # Without words what is set alone
    of_set = "\n".join(contents.blocks_text(parts, None))
    assert "vb_eilgang" in of_set
    every = "\n".join(contents.blocks_text(parts, []))
    assert len(every.splitlines()) > len(of_set.splitlines())


def test_a_list_has_the_kind_of_most_of_its_names_then_of_fewest_errors(tmp_path: Path) -> None:
    for text, kind in (
        ("kopf.log_achs_name Z\ngetriebe[0].vb_eilgang 5\n", "Z"),
        ("messtyp 1\nmittelpkt_diff 5\n", "channel"),
        ("kopf.log_achs_name Z\nmesstyp 1\ngetriebe[0].vb_eilgang 5\n", "Z"),
    ):
        path = tmp_path / "own.lst"
        path.write_text(text, encoding="utf-8")
        if "messtyp" in text and "kopf" in text:
            with pytest.raises(UserError, match="messtyp"):
                contents.read_parts(path)
        else:
            assert list(contents.read_parts(path)) == [kind]
    with pytest.raises(UserError, match=r"gone\.lst"):
        contents.read_parts(tmp_path / "gone.lst")


def test_what_a_key_of_a_fault_may_have_is_told_for_its_kind() -> None:
    rig = read_rig(RIGS / "probe-z.toml")[0]
    for text, has_moments in (("at=soon", True), ("for=soon", False), ("p=2", False)):
        with pytest.raises(UserError) as caught:
            read_faults("drop", f"Z.TPDO1 {text}", rig)
        assert ("motion" in str(caught.value.allowed)) is has_moments, text
        assert caught.value.value == text.partition("=")[2]


def test_the_table_of_faults_has_every_kind_with_its_targets_and_keys() -> None:
    lines = faults_table().splitlines()
    for kind in fault_kinds().values():
        keys = " ".join(
            f"{key}={kind.defaults[key]}" if key in kind.defaults else key for key in kind.keys
        )
        at = lines.index(f"{kind.name}  ({' or '.join(kind.targets)})  {keys}")
        assert lines[at + 1] == f"    {kind.meaning}"
    for name in (*fault_keys(), *fault_moments()):
        assert any(line.startswith(f"  {name}  ") for line in lines), name


# Families and carriers


ROWS = [SimpleNamespace(family=family, carrier=carrier) for family, carrier in
        (("a", "x"), ("a", "y"), ("b", "y"), ("b", "z"))]  # fmt: skip


def test_a_family_has_its_carriers_and_both_together_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(families, "FAMILIES", ROWS)
    assert [families.carriers_of(name) for name in "abc"] == [["x", "y"], ["y", "z"], []]
    assert [families.joined(*pair) for pair in (("a", "y"), ("b", "y"), ("a", "z"))] == [
        ROWS[1], ROWS[2], None,
    ]  # fmt: skip
    by_carrier = [row.carrier for row in ROWS]
    for values, row in (({"carrier": "y"}, ROWS[1]), ({}, ROWS[0]), (None, ROWS[0])):
        assert families._row(values, "carrier", by_carrier) is row
    with pytest.raises(ValidationError) as caught:
        families._row({"carrier": "w"}, "carrier", by_carrier)
    (error,) = caught.value.errors()
    assert (error["loc"], error["input"]) == (("carrier",), "w")
    assert error["msg"].startswith("there is no such carrier; allowed: ")


def test_a_drive_takes_the_family_that_a_list_of_its_axes_names(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A family that the rig itself names stays, and where there is one only nothing is chosen."""
    listed = {"x.lst": "", "y.lst": "b", "z.lst": "a"}
    monkeypatch.setattr(file, "_listed_family", lambda path: listed.get(str(path), ""))
    wired = (("x", "one"), ("y", "one"), ("z", "two"), ("w", "three"))
    axes = {name: {"drive": drive, "list": f"{name}.lst"} for name, drive in wired}

    def named(rows: Any) -> dict[str, str | None]:
        monkeypatch.setattr(file, "FAMILIES", rows)
        drives: dict[str, Any] = {name: {} for name in ("one", "two", "three")}
        drives["own"] = {"family": "b"}
        table = {"drive": drives, "axis": {**axes, "v": {"drive": "own", "list": "z.lst"}}}
        file._name_families(table)
        return {name: drive.get("family") for name, drive in drives.items()}

    assert named(ROWS) == {"one": "b", "two": "a", "three": None, "own": "b"}
    assert named(ROWS[:2]) == {"one": None, "two": None, "three": None, "own": "b"}
