"""The list of a control, with what is unknown here as comments."""

from pathlib import Path

import pytest

from axisrig.bench.tools.params.known import known_text
from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import read_sections

LIST = """# of a control
kopf.achs_nr 1
kopf.reserviert 0
kopf.log_achs_name Z
service_axis 0
getriebe[0].kv 3000
getriebe[0].kv 4000
getriebe[0].foo 1
antr.v_time_base 0
Ende
"""


def test_lines_that_are_refused_are_comments_and_the_rest_is_read(tmp_path: Path) -> None:
    """Four unknown names and a name that is there twice; comments, order and line numbers stay."""
    path = tmp_path / "control.lst"
    path.write_text(LIST, encoding="latin-1")
    with pytest.raises(UserError) as caught:
        read_sections(path, "axis")
    last = (caught.value, *caught.value.further)[-1]
    assert f"`axisrig params known {path} > NEW` makes comments of these 5 lines" in (
        last.hint or ""
    )
    text, count = known_text(path)
    assert count == 5
    lines = text.splitlines()
    assert len(lines) == len(LIST.splitlines())
    assert lines[0] == "# of a control"
    assert [n for n, line in enumerate(lines[1:], 2) if line.startswith("#")] == [3, 5, 7, 8, 9]
    assert lines[2] == "# kopf.reserviert 0  # unknown axis parameter"
    # Each line has its own reason, and the one that was refused first not that of another one
    reasons = {int(one.line or 0): one.message for one in (caught.value, *caught.value.further)}
    assert len(set(reasons.values())) > 1
    for number, reason in reasons.items():
        head = f"# {LIST.splitlines()[number - 1].strip()}  # "
        assert lines[number - 1] == head + " ".join(reason.split())
    path.write_text(text, encoding="utf-8")
    (axis,) = read_sections(path, "axis")
    assert axis.word("kopf.log_achs_name") == "Z"
    assert known_text(path) == (text, 0)


def test_a_few_errors_of_a_list_have_no_such_hint(tmp_path: Path) -> None:
    path = tmp_path / "own.lst"
    path.write_text("kopf.achs_nr 1\nkopf.achs_nam Z\n", encoding="utf-8")
    with pytest.raises(UserError) as caught:
        read_sections(path, "axis")
    assert "params known" not in str(caught.value)


def test_a_file_that_is_missing_is_reported(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="no such list"):
        known_text(tmp_path / "none.lst")


def known(folder: Path, content: bytes) -> tuple[str, int]:
    path = folder / "control.lst"
    path.write_bytes(content)
    return known_text(path)


@pytest.mark.parametrize(
    ("content", "text", "count"),
    [
        (b"", "", 0),
        (b"kopf.achs_nr 1", "kopf.achs_nr 1\n", 0),
        (b"kopf.achs_nr 1\r\nfoo 2\r\n", "kopf.achs_nr 1\n# foo 2  # {}\n", 1),
        (b"\xef\xbb\xbfkopf.achs_nr 1\nfoo 2\n", "kopf.achs_nr 1\n# foo 2  # {}\n", 1),
        (b"# L\xe4nge\n\t foo  2 \n", "# L\ufffdnge\n# foo  2  # {}\n", 1),
    ],
)
def test_files_as_editors_write_them_are_read(
    content: bytes, text: str, count: int, tmp_path: Path
) -> None:
    """With a mark of the encoding, letters of another one, both ends of a line and none."""
    assert known(tmp_path, content) == (text.format("unknown axis parameter"), count)


def test_more_wrong_lines_than_turns_are_all_found_in_one(tmp_path: Path) -> None:
    lines = [f"unknown_{number} {number}" for number in range(30)]
    text, count = known(tmp_path, "\n".join(["kopf.achs_nr 1", *lines]).encode())
    assert count == 30
    assert text.splitlines() == [
        "kopf.achs_nr 1", *(f"# {line}  # unknown axis parameter" for line in lines)
    ]  # fmt: skip


def test_lines_of_an_axis_whose_first_line_is_refused_go_with_it(tmp_path: Path) -> None:
    """Without its number they are of the axis before, which has them already."""
    own = ["kopf.achs_nr 1", "kopf.log_achs_name Z", "getriebe[0].kv 3000"]
    other = ["kopf.achs_nr x", "kopf.log_achs_name C", "getriebe[0].kv 4000"]
    text, count = known(tmp_path, "\n".join([*own, *other]).encode())
    assert count == 3
    lines = text.splitlines()
    assert lines[:3] == own
    assert lines[3].startswith("# kopf.achs_nr x  # kopf.achs_nr (P-AXIS-00016) takes a value")
    assert lines[4:] == [
        f"# {line}  # parameter is already set in line {number}"
        for number, line in enumerate(other[1:], 2)
    ]
    path = tmp_path / "new.lst"
    path.write_text(text, encoding="utf-8")
    (axis,) = read_sections(path, "axis")
    assert axis.word("kopf.log_achs_name") == "Z"


def test_a_list_of_the_channel_keeps_what_the_channel_has(tmp_path: Path) -> None:
    """The kind of a list is that of most of its lines."""
    own = "dist_ctrl[0].kp 1.0\ndist_ctrl[0].v_max 5000\n"
    assert known(tmp_path, f"{own}getriebe[0].kv 3000\n".encode()) == (
        f"{own}# getriebe[0].kv 3000  # unknown channel parameter\n", 1
    )  # fmt: skip


def test_a_missing_file_names_those_beside_it(tmp_path: Path) -> None:
    (tmp_path / "control.lst").write_text(LIST, encoding="utf-8")
    with pytest.raises(UserError, match="no such list") as caught:
        known_text(tmp_path / "contrl.lst")
    assert caught.value.file == str(tmp_path / "contrl.lst")
    assert "control.lst" in (caught.value.hint or "")
    with pytest.raises(UserError, match="no such list"):
        known_text(tmp_path)  # a folder
