"""Files that a rig is made from, FMUs that are foreign, lists that are read once."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.rig.reading import foreign
from axisrig.bench.rig.reading.foreign import foreign_plants, foreign_rigs
from axisrig.bench.rig.reading.once import read_once
from axisrig.bench.rig.reading.sources import rig_files
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import Origin


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
