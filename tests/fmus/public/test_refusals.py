"""What no FMU here can hold stops the build with the place in the model's own text."""

import re
from pathlib import Path

import pytest
from tests.small_fmus import small_fmu

import axisrig.fmus.build as building
from axisrig.fmus import BuildError

FOLDER = Path(__file__).parent

# model, words of the message, the class whose lines may be named, text of the line
REFUSED = [
    ("Refused.StringParameter", "string", "StringParameter", "String name"),
    ("Refused.ExternalFunction", "external", "ExternalFunction", "external_sine(time)"),
    ("Refused.TooManyEquations", "unbalanced", "TooManyEquations", "model TooManyEquations"),
    ("Refused.TooFewEquations", "unbalanced", "TooFewEquations", "model TooFewEquations"),
    ("Refused.UnknownFunction", "bessel", "UnknownFunction", "y = bessel(time)"),
    ("Refused.WrongType", "Boolean", "WrongType", "y = b + 1"),
    ("Refused.RealEquality", "equality", "RealEquality", ""),
    ("Refused.DerOfDiscrete", "discrete", "DerOfDiscrete", ""),
    ("Refused.VariableDelay", "delay", "VariableDelay", "y = delay("),
    ("Refused.Spatial", "spatialDistribution", "Spatial", "spatialDistribution("),
    ("Refused.BooleanArray", "lost the equation of b", "BooleanArray", "Boolean b[2]"),
    ("Refused.IntegerArray", "lost the equation of k", "IntegerArray", "Integer k[2]"),
    ("Refused.RedeclaredModifier", "drops the modifier", "RedeclaredModifier", "redeclare"),
    ("Refused.ConstrainingModifier", "drops the modifier", "ConstrainingModifier", "constrained"),
    ("Refused.NestedRedeclare", "inside the modifier", "NestedRedeclare", "redeclare"),
    ("Refused.InheritedRedeclare", "Heir inherits", "InheritedRedeclare", "redeclare"),
    ("Refused.ClockedSynchronous", "clock", "ClockedSynchronous", ""),
    ("Logic.Algorithmic", "sequential read", "Algorithmic", "n"),
    ("Logic.LaterWins", "sequential read", "LaterWins", "n"),
    ("Language.RecursiveFunction", "recursive", "RecursiveFunction", ""),
    ("Language.InitialAlgorithm", "initial algorithm", "InitialAlgorithm", ""),
    ("Language.IntegerFunction", "without an event", "IntegerFunction", "k = classify("),
    ("Control.DelayedSine", "delay", "DelayedSine", "y = delay(u, 0.3)"),
]


def class_lines(text: str, name: str) -> range:
    """The lines of a class of a package file, from 1."""
    lines = text.splitlines()
    first = next(
        i for i, line in enumerate(lines) if re.match(rf"  (model|function) {name}\b", line)
    )
    return range(first + 1, lines.index(f"  end {name};") + 2)


@pytest.mark.parametrize(("model", "words", "where", "line"), REFUSED, ids=[r[0] for r in REFUSED])
def test_refusal_names_file_and_line(tmp_path, model, words, where, line):
    library = FOLDER / model.partition(".")[0]
    with pytest.raises(BuildError) as error:
        building.build(model, tmp_path / "x.fmu", library)
    assert words.lower() in str(error.value).lower()
    assert error.value.file == f"{library.name}/package.mo"
    text = (library / "package.mo").read_text(encoding="utf-8")
    assert error.value.line in class_lines(text, where)
    assert line in text.splitlines()[error.value.line - 1]
    assert not list(tmp_path.iterdir())


def test_only_classes_that_the_model_uses_are_judged(tmp_path):
    """Whole and Part stand beside two models with a modifier that the compiler drops."""
    assert small_fmu("Refused.Whole", FOLDER / "Refused").is_file()
