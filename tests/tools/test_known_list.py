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
