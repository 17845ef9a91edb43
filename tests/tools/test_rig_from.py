"""`axisrig rig from`: the rig of a machine's lists, with what had to be assumed."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from axisrig.bench.drive.cia402.dictionary.eds import eds_text
from axisrig.bench.drive.cia402.dictionary.profile import DriveProfile
from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.contents import settings_of
from axisrig.bench.tools.project import rig_from as rig_from_module
from axisrig.bench.tools.project.rig_from import _Draft, _write, rig_from
from axisrig.kernel.errors import UserError

Z = """# an axis list of a machine
kopf.achs_nr 3
kopf.log_achs_name Z
kenngr.achs_typ ACHSTYP_TRANSLATOR
kenngr.messachse 1
getriebe[0].wegaufz 4096
getriebe[0].wegaufn 50000
getriebe[0].lose 20
getriebe[0].slep_max 100000
kenngr.swe_pos 900000
kenngr.swe_neg -100000
"""
XY = """kopf.achs_nr 1
kopf.log_achs_name X
kopf.achs_nr 2
kopf.log_achs_name Y
antr.drive_typ_is_not_said 1
"""


@pytest.fixture
def listed(tmp_path: Path) -> Callable[..., list[Path]]:
    """Write lists."""

    def make(**texts: str) -> list[Path]:
        paths = []
        for name, text in texts.items():
            paths.append(tmp_path / f"{name}.lst")
            paths[-1].write_text(text, encoding="utf-8")
        return paths

    return make


def test_a_rig_is_written_that_check_accepts_and_that_counts_its_assumptions(
    listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    """4096 increments in 50000 of 0.1 um are 5 mm; the limits are -10 and 90 mm."""
    rig = tmp_path / "rigs" / "rig.toml"
    rig.parent.mkdir()
    assumed = rig_from(listed(z=Z), None, rig)
    table = tomllib.loads(rig.read_text(encoding="utf-8"))
    assert table["assumed"] == assumed
    assert table["drive"]["z"] == {"encoder_increments": 4096, "lead_mm": 5.0}
    assert table["axis"]["Z"]["accept"] == ["P-AXIS-00103"]
    assert table["axis"]["Z"]["list"] == "../z.lst"
    assert table["plant"]["z"]["start"]["position_start_mm"] == 40
    for words in ("lose = 20 does not act", "4096 increments and 5 mm", "node 1", "touch probe"):
        assert any(words in text for text in assumed), words
    settings = settings_of(rig, [])
    check_rig(settings)
    assert f"{len(assumed)} assumptions of the rig not confirmed" in settings.notes[0]


def test_an_axis_has_the_name_of_its_list_and_the_folder_is_made(
    listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    rig = tmp_path / "new" / "rigs" / "rig.toml"
    rig_from(listed(x=Z.replace("name Z", "name X2_Table")), None, rig)
    settings = settings_of(rig, [])
    check_rig(settings)
    assert list(settings.axis) == ["X2_Table"]
    assert settings.axis["X2_Table"].integer("kenngr.swe_pos") == 900000


def test_a_simulated_probe_and_what_a_channel_list_would_do_are_assumptions(
    listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    """P-AXIS-00112 acts: such an axis would measure without a probe."""
    rig = tmp_path / "rig.toml"
    lists = listed(z=f"{Z}meas_simu.meas_simu_mode 2\n", ch="messtyp 1\nvector.acceleration 5000\n")
    assumed = rig_from(lists, None, rig)
    assert any("simulated probe of the list (P-AXIS-00112 = 2)" in text for text in assumed)
    assert "channel: vector.acceleration = 5000 does not act: the path would be slower" in assumed
    table = tomllib.loads(rig.read_text(encoding="utf-8"))
    assert table["channel"]["accept"] == ["P-CHAN-00002"]
    check_rig(settings_of(rig, []))
    other = tmp_path / "other.toml"
    assert not any("simulated" in text for text in rig_from(listed(z=Z), None, other))


def test_confirmed_assumptions_are_not_counted(
    listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    rig = tmp_path / "rig.toml"
    first, *rest = rig_from(listed(z=Z), None, rig)
    text = rig.read_text(encoding="utf-8")
    for line in rest:
        text = text.replace(f'    "{line}",\n', "")
    rig.write_text(text, encoding="utf-8")
    assert "1 assumption of the rig not confirmed" in settings_of(rig, []).notes[0]
    rig.write_text(text.replace(f'    "{first}",\n', ""), encoding="utf-8")
    assert not any("assumption" in note for note in settings_of(rig, []).notes)


def test_the_feed_constant_of_a_list_is_the_encoder_of_the_rig(
    listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    """2^20 increments, gearbox 2:1 and 20 mm in a turn of the screw: 10 mm in one of the motor."""
    rig = tmp_path / "rig.toml"
    lines = Z.replace("getriebe[0].wegaufz 4096\ngetriebe[0].wegaufn 50000\n", "")
    lines += (
        "getriebe[0].incr_per_rev 1048576\ngetriebe[0].feed_const_num 200000\n"
        "getriebe[0].gear_fact_num 2\n"
    )
    assumed = rig_from(listed(z=lines), None, rig)
    table = tomllib.loads(rig.read_text(encoding="utf-8"))
    assert table["drive"]["z"] == {"encoder_increments": 1_048_576, "lead_mm": 10.0}
    assert table["axis"]["Z"]["accept"] == ["P-AXIS-00103"]
    assert any("P-AXIS-00092, 00362, 00363, 00511, 00512" in text for text in assumed)
    check_rig(settings_of(rig, []))


@pytest.mark.long
def test_several_axes_a_channel_list_and_an_eds(
    listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    """Axes without a resolution get one that is assumed, each with a bus of its own."""
    axes = XY.replace("antr.drive_typ_is_not_said 1\n", "")
    eds = tmp_path / "drive.eds"
    profile = DriveProfile()
    eds.write_text(eds_text(profile), encoding="ascii")
    rig = tmp_path / "rig.toml"
    assumed = rig_from(listed(xy=axes, z=Z, ch="messtyp 1\n"), eds, rig)
    table = tomllib.loads(rig.read_text(encoding="utf-8"))
    assert list(table["axis"]) == ["X", "Y", "Z"]
    assert [axis["segment"] for axis in table["axis"].values()] == ["can1", "can2", "can3"]
    assert {drive["eds"] for drive in table["drive"].values()} == {"drive.eds"}
    assert table["channel"]["list"] == "ch.lst"
    assert sum("since the list does not say" in text for text in assumed) == 2
    check_rig(settings_of(rig, []))


def axis(name: str, number: int, *lines: str) -> str:
    head = (f"kopf.achs_nr {number}", f"kopf.log_achs_name {name}")
    return "".join(f"{line}\n" for line in (*head, *lines))


MEASURES, AS_TYPE_2 = "kenngr.messachse 1", "kenngr.antr_typ 2"


def test_each_axis_has_a_bus_a_node_a_drive_and_a_plant_of_its_own(
    listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    """Of four axes that measure the first three are at the probe; V measures nothing."""
    rig = tmp_path / "rigs" / "rig.toml"
    rig.parent.mkdir()
    lists = listed(
        v=axis("V", 7, "kenngr.swe_pos 1300000", "kenngr.swe_neg 1000000"),
        w=axis("W", 1, MEASURES), xy=axis("X", 2, MEASURES, AS_TYPE_2) + axis("Y", 3, MEASURES),
        z=axis("Z", 4, MEASURES, "kenngr.swe_pos 1300001"), ch="messtyp 1\n",
    )  # fmt: skip
    assumed = rig_from(lists, tmp_path / "drive.eds", rig)
    table = tomllib.loads(rig.read_text(encoding="utf-8"))
    places = [(name, t["segment"], t["node"], t["drive"], t["plant"], t["list"])
              for name, t in table["axis"].items()]  # fmt: skip
    assert places == [
        (name, f"can{n}", n, name.lower(), name.lower(), f"../{file}.lst")
        for n, (name, file) in enumerate(zip("VWXYZ", ("v", "w", "xy", "xy", "z"), strict=True), 1)
    ]
    assert list(table["segment"]) == [f"can{n}" for n in range(1, 6)]
    assert table["channel"]["list"] == "../ch.lst"
    measures = {name: t.get("probe_1", "") + t.get("probe_2", "") for name, t in
                table["axis"].items()}  # fmt: skip
    assert measures == {"V": "", "W": "probe" * 2, "X": "probe" * 2, "Y": "probe" * 2, "Z": ""}
    assert table["plant"]["probe"]["wire"] == {"x": "w", "y": "x", "z": "y"}
    assert any(text.startswith("no probe on Z:") for text in assumed)
    assert "a touch probe on W, X, Y, above a surface at 100 mm of input z" in assumed
    starts = {name: t["start"]["position_start_mm"] for name, t in table["plant"].items()
              if name != "probe"}  # fmt: skip
    # 130 mm is inside the limits of no list; V ends there, between 100 and 130
    assert starts == {"v": 115, "w": 130, "x": 130, "y": 130, "z": 130}
    drives = table["drive"]
    assert [name for name, t in drives.items() if "as_canopen" in t] == ["x"]
    assert {t["eds"] for t in drives.values()} == {"../drive.eds"}
    assert "axis X: a CANopen drive in place of SERCOS (P-AXIS-00020)" in assumed


@pytest.mark.parametrize(
    ("number", "name"),
    [
        (1, "conventional"), (2, "SERCOS"), (3, "PROFIDRIVE MC"), (4, "simulation"),
        (5, "Lightbus"), (6, "terminal"), (7, "RT-Ethernet"), (16, "virtual"), (32, "CAN"), (8, ""),
    ],
)  # fmt: skip
def test_a_drive_of_another_type_is_a_canopen_drive_in_its_place(
    number: int, name: str, listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    """P-AXIS-00020, FCT-C4 6: whichever it is, the rig says so and counts it as assumed."""
    rig = tmp_path / "rig.toml"
    assumed = rig_from(listed(z=axis("Z", 1, f"kenngr.antr_typ {number}")), None, rig)
    table = tomllib.loads(rig.read_text(encoding="utf-8"))
    words = f"axis Z: a CANopen drive in place of {name} (P-AXIS-00020)"
    assert table["drive"]["z"].get("as_canopen", False) is bool(name)
    assert [text for text in assumed if "in place of" in text] == ([words] if name else [])
    assert table["assumed"] == assumed


@pytest.mark.parametrize(
    ("low", "high", "start_mm"),
    [
        (1_299_999, 1_300_001, 130.0),  # 30 mm above the surface at 100 mm, inside of the limits
        (1_300_000, 1_400_000, 135.0),
        (1_200_000, 1_300_000, 125.0),
        (-500_000, 100_000, -20.0),
        (1_000_000, 1_002_460, 100.123),
        (2_000_000, 3_000_000, 250.0),
    ],
)
def test_an_axis_begins_clear_of_the_surface_or_in_the_middle_of_its_limits(
    low: int, high: int, start_mm: float, listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    """Limits of a list are in 0.1 um; one that is reached is none to begin at."""
    rig = tmp_path / "rig.toml"
    limits = (f"kenngr.swe_neg {low}", f"kenngr.swe_pos {high}")
    assumed = rig_from(listed(z=axis("Z", 1, *limits)), None, rig)
    table = tomllib.loads(rig.read_text(encoding="utf-8"))
    assert table["plant"]["z"]["start"] == {"position_start_mm": start_mm}
    assert any(text.endswith(f"ServoAxis; it begins at {start_mm:g} mm") for text in assumed)


@pytest.mark.parametrize(
    ("measuring", "wire"),
    [("", None), ("X", {"z": "x"}), ("XY", {"x": "x", "y": "y"})],
)
def test_the_probe_is_at_the_axes_that_measure(
    measuring: str, wire: dict[str, str] | None, listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    """The only one is the axis of the tool."""
    texts = {
        name.lower(): axis(name, number, *([MEASURES] if name in measuring else []))
        for number, name in enumerate("XY", 1)
    }
    rig_from(listed(**texts), None, tmp_path / "rig.toml")
    table = tomllib.loads((tmp_path / "rig.toml").read_text(encoding="utf-8"))
    assert table["plant"].get("probe", {}).get("wire") == wire
    assert table["channel"]["list"] == "rig-channel.lst"
    assert (tmp_path / "rig-channel.lst").is_file()


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        ({"ch": "messtyp 1\n"}, "no axis list"),
        ({"z": Z, "again": Z}, "two lists are of the same axis"),
        ({"z": "kenngr.messachse 1\n"}, "does not name its axis"),
        ({"z": XY}, "unknown axis parameter"),
    ],
)
def test_lists_that_make_no_rig_are_refused(
    listed: Callable[..., list[Path]], tmp_path: Path, texts: dict[str, str], message: str
) -> None:
    with pytest.raises(UserError, match=message):
        rig_from(listed(**texts), None, tmp_path / "rig.toml")
    assert not (tmp_path / "rig.toml").exists()


def test_a_rig_that_is_there_is_not_overwritten(
    listed: Callable[..., list[Path]], tmp_path: Path
) -> None:
    (tmp_path / "rig.toml").touch()
    with pytest.raises(UserError, match="there already"):
        rig_from(listed(z=Z), None, tmp_path / "rig.toml")


def test_a_list_that_is_neither_of_an_axis_nor_of_a_channel_is_refused(
    listed: Callable[..., list[Path]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As one of zero offsets or of tools; it is named, and nothing is written."""
    paths = listed(z=Z, tools="wz[1].gueltig 1\n")
    read = rig_from_module.read_parts

    def parts(path: Path) -> dict[str, Any]:
        return {"tools": SimpleNamespace(kind="tools")} if path == paths[1] else dict(read(path))

    monkeypatch.setattr(rig_from_module, "read_parts", parts)
    with pytest.raises(UserError, match="neither an axis list nor a channel list") as caught:
        rig_from(paths, None, tmp_path / "rig.toml")
    assert caught.value.file == str(paths[1])
    assert not (tmp_path / "rig.toml").exists()


def test_an_assumption_is_in_the_rig_as_it_was_said(tmp_path: Path) -> None:
    """Names of files may have signs that TOML has for itself."""
    said = ['a "quoted" word', "back\\slash", 'both \\" of them', "C:\\new\\table.lst", "plain"]
    draft = _Draft(assumed=said)
    draft.add("channel", 'list = "c.lst"')
    output = tmp_path / "rig.toml"
    _write(draft, [Path("a.lst"), Path("lists/b.lst")], output)
    found = tomllib.loads(output.read_text(encoding="utf-8"))
    assert found == {
        "title": "machine of a.lst, b.lst", "assumed": said, "channel": {"list": "c.lst"},
    }  # fmt: skip


@pytest.mark.parametrize("order", ["XYZ", "ZYX", "YZX"])
def test_axes_of_a_rig_are_in_the_order_of_the_lists_that_were_given(
    order: str, tmp_path: Path
) -> None:
    """Each has the node and the segment of its place."""
    lists = [tmp_path / f"{name}.lst" for name in order]
    for name, path in zip(order, lists, strict=True):
        path.write_text(f"kopf.achs_nr 1\nkopf.log_achs_name {name}\n", encoding="utf-8")
    rig = tmp_path / "rig.toml"
    rig_from(lists, None, rig)
    axes = settings_of(rig, []).rig.axis
    assert [(name, one.segment, one.node_id) for name, one in axes.items()] == [
        (name, f"can{place}", place) for place, name in enumerate(order, 1)
    ]
