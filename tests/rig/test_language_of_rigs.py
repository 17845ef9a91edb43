"""`[language] pass_over` of a rig: which words of programs count for nothing."""

from pathlib import Path

import pytest

from axisrig.bench.rig.contents import settings_of
from axisrig.kernel.errors import UserError

BASE = Path("testplans/rigs/probe-z.toml").resolve()


def rig(folder: Path, words: str) -> Path:
    path = folder / "rig.toml"
    path.write_text(f'base = "{BASE}"\n[language]\npass_over = {words}\n', encoding="utf-8")
    return path


def test_every_run_says_what_is_passed_over(tmp_path: Path) -> None:
    notes = settings_of(rig(tmp_path, '["#TIMER", "G25"]'), []).notes
    assert [
        note.partition(" of a program is passed over: ")[0] for note in notes if "passed" in note
    ] == [
        "#TIMER",
        "G25",
    ]
    assert not any("passed over" in note for note in settings_of(BASE, []).notes)


@pytest.mark.parametrize(
    ("words", "said", "allowed"),
    [
        (
            '["#HSC ON"]',
            "#HSC ON may not be passed over: it acts, or would act on the machine",
            "#TIMER",
        ),
        ('["#TIMER", "#TIMRE"]', "no published word", "#TIMER"),
        ('["G41"]', "G41 may not be passed over", "G25"),
        ('["#CS ON"]', "#CS ON may not be passed over", "#TIMER"),
        ('["G20"]', "G20 may not be passed over", "G25"),
    ],
)
def test_what_acts_on_the_machine_is_refused_with_its_place(
    tmp_path: Path, words: str, said: str, allowed: str
) -> None:
    with pytest.raises(UserError, match=said) as refused:
        settings_of(rig(tmp_path, words), [])
    assert (Path(str(refused.value.file)).name, refused.value.line) == ("rig.toml", 3)
    assert allowed in str(refused.value.allowed)
