"""What no FMU here can hold stops the build with the place in the model's own text."""

import re
from pathlib import Path

import pytest

import fmus.build as building
from fmus import BuildError

FOLDER = Path(__file__).parent

# model, words of the message, the class whose lines may be named
REFUSED = [
    ("Refused.StringParameter", "string", "StringParameter"),
    ("Refused.ExternalFunction", "external", "external_sine"),
    ("Refused.TooManyEquations", "unbalanced", "TooManyEquations"),
    ("Refused.TooFewEquations", "unbalanced", "TooFewEquations"),
    ("Refused.UnknownFunction", "bessel", "UnknownFunction"),
    ("Refused.WrongType", "Boolean", "WrongType"),
    ("Refused.RealEquality", "equality", "RealEquality"),
    ("Refused.DerOfDiscrete", "discrete", "DerOfDiscrete"),
    ("Refused.VariableDelay", "delay", "VariableDelay"),
    ("Refused.Spatial", "spatialDistribution", "Spatial"),
    ("Refused.BooleanArray", "lost the equation of b", "BooleanArray"),
    ("Refused.IntegerArray", "lost the equation of k", "IntegerArray"),
    ("Refused.RedeclaredModifier", "drops the modifier", "RedeclaredModifier"),
    ("Refused.ConstrainingModifier", "drops the modifier", "ConstrainingModifier"),
    ("Refused.ClockedSynchronous", "clock", "ClockedSynchronous"),
]


def class_lines(text: str, name: str) -> range:
    """The lines of a class of a package file, from 1."""
    lines = text.splitlines()
    first = next(
        i for i, line in enumerate(lines) if re.match(rf"  (model|function) {name}\b", line)
    )
    return range(first + 1, lines.index(f"  end {name};") + 2)


@pytest.mark.parametrize(("model", "words", "where"), REFUSED, ids=[r[0] for r in REFUSED])
def test_refusal_names_file_and_line(tmp_path, model, words, where):
    with pytest.raises(BuildError) as error:
        building.build(model, tmp_path / "x.fmu", FOLDER / "Refused")
    assert words.lower() in str(error.value).lower()
    assert error.value.file == "Refused/package.mo"
    text = (FOLDER / "Refused" / "package.mo").read_text(encoding="utf-8")
    assert error.value.line in class_lines(text, where)
    assert not list(tmp_path.iterdir())


def test_only_classes_that_the_model_uses_are_judged(tmp_path):
    """Whole and Part stand beside two models with a modifier that the compiler drops."""
    assert building.build("Refused.Whole", tmp_path / "x.fmu", FOLDER / "Refused").is_file()
