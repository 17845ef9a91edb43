"""The token of an FMU binds C source and description: what it follows, and where it stands."""

from types import SimpleNamespace

import pytest

from axisrig.fmus.writing import generate as writing
from axisrig.fmus.writing.description import TOKEN_MARK


@pytest.fixture
def parts(tmp_path, monkeypatch):
    """Texts that say what they were made of; two runtimes, which share a file."""
    for name in ("own2.c", "own3.c", "both.h"):
        (tmp_path / name).write_text(f"/* {name} */", encoding="utf-8")
    files = {"2.0": ("own2.c", "both.h"), "3.0": ("own3.c", "both.h")}
    made = SimpleNamespace(folder=tmp_path, source="source", description="description")
    stand_ins = {
        "TARGET": tmp_path,
        "runtime_files": lambda fmi: files[fmi],
        "read_system": lambda ir: f"system of {ir.model}",
        "folded_slots": lambda ir, system: "folded",
        "Texts": lambda ir: "texts",
        "refuse_unknown_modifiers": lambda ir, texts: None,
        "read_variables": lambda *_: ["array"],
        "scalars": lambda variables: [f"elements of {one}" for one in variables],
        "with_notes": lambda variables, folded: [f"{one}, {folded}" for one in variables],
        "write_source": lambda ir, system, variables, folded, step_s, slave: (
            f"{made.source} {variables} {step_s} {slave} {TOKEN_MARK}"
        ),
        "describe": lambda ir, texts, system, variables, step_s, fmi: (
            f"{made.description} {variables} {step_s} {fmi} {TOKEN_MARK}"
        ),
        "other_files": lambda model, texts, variables, head, fmi: {"icon": model.encode()},
        "head_of": lambda ir, texts: "head",
        "identifier_of": lambda model: model.replace(".", "_"),
    }
    for name, stand_in in stand_ins.items():
        monkeypatch.setattr(writing, name, stand_in)
    return made


def tokens(step_s=1e-3):
    ir = SimpleNamespace(model="L.Own")
    return [writing.generate(ir, step_s, fmi).token for fmi in ("2.0", "3.0")]


@pytest.mark.parametrize(
    ("file", "changed"),
    [("own2.c", [True, False]), ("own3.c", [False, True]), ("both.h", [True, True])],
)
def test_the_token_follows_the_runtime_of_its_own_version(parts, file, changed):
    before = tokens()
    (parts.folder / file).write_text("/* another */", encoding="utf-8")
    assert [a != b for a, b in zip(before, tokens(), strict=True)] == changed


def test_the_token_follows_each_text_and_is_the_same_for_the_same_texts(parts):
    before = tokens()
    assert tokens() == before
    assert before[0] != before[1]
    assert tokens(2e-3)[1] != before[1]
    found = {before[1]}
    for name in ("source", "description"):
        setattr(parts, name, "another")
        found.add(tokens()[1])
    assert len(found) == 3


def test_both_texts_have_the_token_and_the_elements_of_arrays_are_of_version_2_alone(parts):
    ir = SimpleNamespace(model="L.Own")
    for fmi, shown in (("2.0", "elements of array, folded"), ("3.0", "array, folded")):
        made = writing.generate(ir, 1e-3, fmi)
        assert (made.model, made.fmi, made.identifier) == ("L.Own", fmi, "L_Own")
        assert len(made.token) == 32
        assert made.others == {"icon": b"L.Own"}
        for text in (made.source, made.description):
            assert f"['{shown}']" in text
            assert text.endswith(f" {made.token}")
            assert TOKEN_MARK not in text
        assert f" {fmi} " in made.description
        assert writing.SLAVES[fmi][0] in made.source
