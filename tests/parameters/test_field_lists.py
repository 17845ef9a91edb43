"""Lists of real machines: their forms, their names, and what does not act here."""

import random
from collections.abc import Callable
from pathlib import Path

import pytest

from axisrig.bench.rig.check import check_rig
from axisrig.bench.rig.reading.file import read_rig
from axisrig.bench.rig.settings import Settings, read_settings
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters.influence import group_of, grouped, groups
from axisrig.kernel.parameters.lists import read_list
from axisrig.kernel.parameters.table import Kind, table

RIGS = Path(__file__).resolve().parents[2] / "testplans" / "rigs"
SETTINGS = {
    "getriebe[i].moduloo": "2", "kenngr.set_refpos_mode": "PLC", "filter[i].prototype": "BESSEL",
    "kenngr.write_reference_position_to_drive": "ON_CNC_SIDE",
}  # fmt: skip
"""Values that are not neutral, where a number other than the default is none."""


@pytest.fixture
def with_list(tmp_path: Path) -> Callable[..., Settings]:
    """Read the rig of one axis with further lines in its list, and keys of its axis."""

    def make(lines: str, keys: str = "", channel: str = "", channel_keys: str = "") -> Settings:
        rig = (RIGS / "probe-z.toml").read_text(encoding="utf-8")
        own = (RIGS / "lists" / "axis-z-fine.lst").read_text(encoding="utf-8")
        (tmp_path / "axis.lst").write_text(f"{own}\n{lines}\n", encoding="utf-8")
        own = (RIGS / "lists" / "channel.lst").read_text(encoding="utf-8")
        (tmp_path / "channel.lst").write_text(f"{own}\n{channel}\n", encoding="utf-8")
        rig = rig.replace("lists/axis-z-fine.lst", "axis.lst")
        rig = rig.replace("lists/channel.lst", "channel.lst")
        rig = rig.replace("[channel]", f"[channel]\n{channel_keys}")
        (tmp_path / "rig.toml").write_text(
            rig.replace("[axis.Z]", f"[axis.Z]\n{keys}"), encoding="utf-8"
        )
        return read_settings(*read_rig(tmp_path / "rig.toml"), [])

    return make


def rows(*, must_act: bool) -> list[str]:
    """Return the paths of one class."""
    found = [path for kind, path in grouped() if kind == "axis"]
    return [path for path in found if _group(path).must_act == must_act]


def _group(path: str, kind: Kind = "axis"):
    group = group_of(kind, path)
    assert group is not None
    return group


def channel_rows(*, must_act: bool) -> list[str]:
    """Return the paths of one class of channel lists."""
    found = [path for kind, path in grouped() if kind == "channel"]
    return [path for path in found if _group(path, "channel").must_act == must_act]


def _odd(path: str, kind: Kind = "axis") -> tuple[str, str]:
    """Return a written path and a value that is not neutral."""
    row = table(kind).row(path)
    assert row is not None
    default = int(float(row.default)) if not isinstance(row.default, str) else 0
    value = SETTINGS.get(path) or str(0 if row.default is True else default + 1)
    return path.replace("[i]", "[0]"), value


def test_every_name_of_real_lists_has_a_class_and_does_not_act() -> None:
    """What has a class is a row of the tables; each group has members and a reason."""
    field = [r for k in ("axis", "channel") for r in table(k).parameters if r.topic == "field.csv"]
    assert len(field) > 70
    assert [row.path for row in field if group_of(row.kind, row.path) is None] == []
    for kind, path in grouped():
        row = table(kind).row(path)
        assert row is not None, path
        assert row.acts == "no"
    assert {_group(path, kind).name for kind, path in grouped()} == set(groups())
    assert all(group.reason for group in groups().values())


@pytest.mark.parametrize("path", rows(must_act=False)[:3])
def test_what_has_no_influence_is_kept_and_counted(
    with_list: Callable[..., Settings], path: str
) -> None:
    name, value = _odd(path)
    (note,) = [text for text in with_list(f"{name} {value}").notes if "influence" in text]
    assert "axis Z: 1 setting has no influence here (axis.lst)" in note


def test_all_that_has_no_influence_is_one_line(with_list: Callable[..., Settings]) -> None:
    paths = [path for path in rows(must_act=False) if _group(path).name != "edge banding"]
    settings = with_list("\n".join(" ".join(_odd(path)) for path in paths))
    (note,) = [text for text in settings.notes if "influence" in text]
    assert f"{len(paths)} settings have no influence here" in note
    assert not any("not act yet" in text for text in settings.notes)


@pytest.mark.long(but=4)
@pytest.mark.parametrize("path", rows(must_act=True))
def test_what_would_act_is_refused_unless_it_is_accepted(
    with_list: Callable[..., Settings], path: str
) -> None:
    name, value = _odd(path)
    row = table("axis").row(path)
    assert row is not None
    with pytest.raises(UserError, match="does not act here") as error:
        with_list(f"{name} {value}")
    assert _group(path).reason in error.value.message
    assert error.value.line is not None
    for word in {row.number or path, path}:
        settings = with_list(f"{name} {value}", f'accept = ["{word}"]')
        (note,) = [text for text in settings.notes if "is accepted" in text]
        assert name in note
        assert _group(path).reason in note


@pytest.mark.parametrize("path", channel_rows(must_act=True))
def test_what_would_act_of_a_channel_list_is_refused_unless_it_is_accepted(
    with_list: Callable[..., Settings], path: str
) -> None:
    """Beside an axis list that accepts something of its own."""
    name, value = _odd(path, "channel")
    row = table("channel").row(path)
    assert row is not None
    axis = ("getriebe[0].lose 5", 'accept = ["P-AXIS-00103"]')
    with pytest.raises(UserError, match="does not act here") as error:
        with_list(*axis, f"{name} {value}")
    assert _group(path, "channel").reason in error.value.message
    assert "in [channel]: every run then says so" in str(error.value.hint)
    settings = with_list(*axis, f"{name} {value}", f'accept = ["{row.number}"]')
    notes = [text for text in settings.notes if "is accepted" in text]
    assert [text.partition(":")[0] for text in notes] == ["channel", "axis Z"]
    assert name in notes[0]


def test_what_has_no_influence_of_a_channel_list_is_counted(
    with_list: Callable[..., Settings],
) -> None:
    paths = channel_rows(must_act=False)
    lines = "\n".join(" ".join(_odd(path, "channel")) for path in paths)
    (note,) = [text for text in with_list("", channel=lines).notes if "influence" in text]
    assert f"channel: {len(paths)} settings have no influence here (channel.lst)" in note


@pytest.mark.parametrize("value", ["0", "10000"])
def test_the_inner_units_of_the_field_are_neutral(
    with_list: Callable[..., Settings], value: str
) -> None:
    """P-CHAN-00315: 0 takes P-CHAN-00034 to 00036, 10000 is a unit of 0.1 um."""
    same = with_list("", channel=f"resolution_factor {value}\nlin_aufloes 10000").notes
    assert same == with_list("").notes
    with pytest.raises(UserError, match="wrong by a factor"):
        with_list("", channel="resolution_factor 1000")


@pytest.mark.parametrize("path", rows(must_act=True)[:3])
def test_a_neutral_value_says_nothing(with_list: Callable[..., Settings], path: str) -> None:
    row = table("axis").row(path)
    assert row is not None
    name = path.replace("[i]", "[0]")
    default = int(row.default) if not isinstance(row.default, str) else row.default
    assert with_list(f"{name} {default}").notes == with_list("").notes


def test_all_that_would_act_is_said_at_once(with_list: Callable[..., Settings]) -> None:
    with pytest.raises(UserError) as error:
        with_list("getriebe[0].lose 20\nlr_param.ssfk 1\nlr_hw[0].vz_stellgr 1")
    messages = [error.value, *error.value.further]
    numbers = ("P-AXIS-00231", "P-AXIS-00103", "P-AXIS-00175")
    assert [number in str(each) for number, each in zip(numbers, messages, strict=True)] == [
        True
    ] * 3


@pytest.mark.parametrize(
    ("counts", "path", "fits"),
    [(1_048_576, 100_000, True), (2_097_152, 200_000, True), (1_048_576, 50_000, False),
     (1_048_577, 100_000, False)],
)  # fmt: skip
def test_a_resolution_is_that_of_the_encoder_of_the_rig(
    with_list: Callable[..., Settings], counts: int, path: int, fits: bool
) -> None:
    """The drive has 1048576 increments in 10 mm, which are 100000 of 0.1 um."""
    lines = f"getriebe[0].wegaufz {counts}\ngetriebe[0].wegaufn {path}"
    if fits:
        check_rig(with_list(lines))
        return
    with pytest.raises(UserError, match="wrong by a factor"):
        with_list(lines)


@pytest.mark.parametrize(
    ("per_turn", "feed", "turns", "gear_in", "gear_out", "fits"),
    [(1_048_576, 100_000, 1, 1, 1, True), (1_048_576, 200_000, 2, 1, 1, True),
     (1_048_576, 200_000, 1, 2, 1, True), (524_288, 100_000, 1, 6, 3, True),
     (1_048_576, 300_000, 1, 1, 1, False), (1_048_576, 200_000, 1, 1, 2, False),
     (1024, 100_000, 1, 1, 1, False)],
)  # fmt: skip
def test_a_feed_constant_and_a_gearbox_are_the_encoder_of_the_rig(
    with_list: Callable[..., Settings],
    per_turn: int,
    feed: int,
    turns: int,
    gear_in: int,
    gear_out: int,
    fits: bool,
) -> None:
    """Increments per mm: per_turn (gear_in/gear_out) / (feed/turns), in 0.1 um; 104857.6 here."""
    lines = (
        f"getriebe[0].incr_per_rev {per_turn}\ngetriebe[0].feed_const_num {feed}\n"
        f"getriebe[0].feed_const_denom {turns}\ngetriebe[0].gear_fact_num {gear_in}\n"
        f"getriebe[0].gear_fact_denom {gear_out}\n"
    )
    if fits:
        check_rig(with_list(lines))
        return
    with pytest.raises(UserError, match="wrong by a factor") as error:
        with_list(lines)
    listed = per_turn * gear_in / gear_out / (feed / turns) * 10_000
    allowed = str(error.value.allowed)
    assert allowed.startswith("104857.6 increments per mm, those of the drive; the list has ")
    assert float(allowed.rpartition(" ")[2]) == pytest.approx(listed, rel=1e-8)


@pytest.mark.parametrize(
    ("name", "index"),
    [
        ("getriebe[0].lose", None), ("getriebe[1].lose", 1), ("getriebe[3].lose", 3),
        ("lr_param.ssfk", None), ("lr_hw[0].vz_stellgr", None), ("lr_hw[1].vz_stellgr", 1),
    ],
)  # fmt: skip
def test_an_element_behind_the_first_is_named_with_its_index(
    with_list: Callable[..., Settings], name: str, index: int | None
) -> None:
    """One number stands for all of them."""
    _, value = _odd(name.replace("[0]", "[i]").replace("[1]", "[i]").replace("[3]", "[i]"))
    with pytest.raises(UserError) as error:
        with_list(f"{name} {value}")
    (number,) = [word for word in error.value.message.split() if word.startswith("(P-AXIS-")]
    of = "" if index is None else f" (index {index})"
    assert error.value.message.startswith(f"{name} {number}{of} does not act here: ")


@pytest.mark.parametrize(("kind", "unit"), [("TRANSLATOR", "mm"), ("ROTATOR", "degree")])
def test_a_wrong_resolution_counts_in_mm_or_in_degrees(
    with_list: Callable[..., Settings], kind: str, unit: str
) -> None:
    """10 mm are 10 degrees of an axis that turns."""
    lines = "getriebe[0].wegaufz 1048576\ngetriebe[0].wegaufn 50000"
    with pytest.raises(UserError) as error:
        with_list(f"kenngr.achs_typ ACHSTYP_{kind}\n{lines}")
    assert str(error.value.allowed) == (
        f"104857.6 increments per {unit}, those of the drive; the list has 209715.2"
    )


def test_a_resolution_in_both_ways_is_refused(with_list: Callable[..., Settings]) -> None:
    """The page of P-AXIS-00234 wants P-AXIS-00362 and 00363 at 1 then."""
    lines = "getriebe[0].wegaufz 1048576\ngetriebe[0].wegaufn 100000\n"
    check_rig(with_list(lines + "getriebe[0].feed_const_num 1\ngetriebe[0].feed_const_denom 1"))
    with pytest.raises(UserError, match="resolution of the encoder twice") as error:
        with_list(lines + "getriebe[0].feed_const_num 100000")
    assert error.value.line is not None


@pytest.mark.parametrize("word", ["P-AXIS-99999", "getriebe[0].looose", "P-AXIS-00213"])
def test_only_what_would_act_can_be_accepted(with_list: Callable[..., Settings], word: str) -> None:
    with pytest.raises(UserError, match="no parameter that has to be accepted"):
        with_list("", f'accept = ["{word}"]')


FORMS = """/* head of the list
   kenngr.messachse 7
*/
( another comment )
  (and one more
kopf.achs_nr 3   /* in a line */
kopf.log_achs_name Z ( name
kenngr.messachse 1
Ende
"""


def test_forms_of_lists_of_the_field(tmp_path: Path) -> None:
    path = tmp_path / "some.lst"
    path.write_text(FORMS, encoding="utf-8")
    parameters = read_list(path, "axis")
    assert parameters.integer("kopf.achs_nr") == 3
    assert parameters.word("kopf.log_achs_name") == "Z"
    assert parameters.flag("kenngr.messachse")
    path.write_text(FORMS + "kenngr.wrong 1\n", encoding="utf-8")
    with pytest.raises(UserError, match="unknown") as error:
        read_list(path, "axis")
    assert error.value.line == FORMS.count("\n") + 1


def typo(draw: random.Random) -> tuple[str, str]:
    """Return a name with one mistake of typing, and the right one."""
    known = {path for row in table("axis").parameters for path in (row.path, *row.old_paths)}
    while True:
        right = draw.choice(sorted(known))
        stem, dot, word = right.rpartition(".")
        if len(word) < 6:
            continue
        at = draw.randrange(1, len(word) - 1)
        wrong = draw.choice(
            (word[:at] + word[at + 1 :], word[:at] + word[at] + word[at:],
             word[:at] + word[at + 1] + word[at] + word[at + 2 :],
             word[:at] + draw.choice("abcdefghijklmnopqrstuvwxyz") + word[at + 1 :])
        )  # fmt: skip
        name = f"{stem}{dot}{wrong}"
        if name not in known:
            return name.replace("[i]", "[0]"), right.replace("[i]", "[0]")


@pytest.mark.long
def test_of_50_typos_all_are_refused_and_48_have_the_right_proposal(tmp_path: Path) -> None:
    draw = random.Random(38)
    path, right = tmp_path / "some.lst", 0
    for _ in range(50):
        wrong, meant = typo(draw)
        path.write_text(f"{wrong} 1\n", encoding="utf-8")
        with pytest.raises(UserError) as error:
            read_list(path, "axis")
        right += meant in str(error.value)
    assert right >= 48
