"""Whole arrays in functions, against numpy; formats of messages; options of a build."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from axisrig.fmus.build import DEFAULT_STEP_S, MODELS, _pack, _step_s, _targets, place_in_cache
from axisrig.fmus.compiler import PLATFORMS, this_platform
from axisrig.fmus.equations.actions import read_message, start_check
from axisrig.fmus.reading.arrays import ARRAYS, Value, elementwise, indexed, matrix_product, whole
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import (
    Expr,
    UnsupportedError,
    apply,
    const,
    parameter,
    variable,
)

Numbers = npt.NDArray[np.float64]


def value(numbers: Any) -> Value:
    array = np.asarray(numbers, dtype=float)
    return Value([const(x) for x in array.ravel()], array.shape)


def numbers(found: Value) -> Numbers:
    assert all(part.kind == "const" for part in found.parts)
    return np.array([part.value for part in found.parts]).reshape(found.dimensions)


MATRIX = np.array([[1.0, 2.0, 3.0], [4.0, -5.0, 6.5]])
SQUARE = np.array([[2.0, 1.0, 0.0], [0.5, -1.0, 3.0], [4.0, 4.0, -2.0]])
VECTOR = np.array([2.0, -3.0, 0.5])


@pytest.mark.parametrize(
    ("left", "right"),
    [(MATRIX, VECTOR), (VECTOR, MATRIX.T), (MATRIX, SQUARE), (SQUARE, SQUARE), (VECTOR, VECTOR),
     (MATRIX[:1], MATRIX[:1].T)],
)  # fmt: skip
def test_products_of_vectors_and_matrices(left: Numbers, right: Numbers) -> None:
    found = matrix_product(value(left), value(right))
    assert numbers(found) == pytest.approx(left @ right)
    assert found.dimensions == (left @ right).shape


@pytest.mark.parametrize(
    ("name", "arguments", "expected"),
    [
        ("transpose", [MATRIX], MATRIX.T),
        ("fill", [7.5, 2, 3], np.full((2, 3), 7.5)),
        ("zeros", [3], np.zeros(3)),
        ("ones", [2, 1], np.ones((2, 1))),
        ("identity", [3], np.eye(3)),
        ("diagonal", [VECTOR], np.diag(VECTOR)),
        ("cross", [VECTOR, SQUARE[1]], np.cross(VECTOR, SQUARE[1])),
        ("cross", [SQUARE[1], VECTOR], -np.cross(VECTOR, SQUARE[1])),
        ("promoted_cat1", [MATRIX, SQUARE], np.vstack([MATRIX, SQUARE])),
        ("promoted_cat1", [1.5, VECTOR], np.array([1.5, *VECTOR])),
        ("promoted_cat1", [VECTOR, SQUARE[0]], np.concatenate([VECTOR, SQUARE[0]])),
        ("promoted_cat2", [SQUARE, MATRIX.T], np.hstack([SQUARE, MATRIX.T])),
        ("promoted_cat2", [VECTOR, SQUARE], np.column_stack([VECTOR, SQUARE])),
        ("promoted_cat2", [1.0, 2.0], np.array([[1.0, 2.0]])),
        ("div", [[7.0, -7.0, 7.0, -7.0], [2.0, 2.0, -2.0, -2.0]], [3, -3, -3, 3]),
        ("rem", [[7.0, -7.0, 7.0, -7.0], [2.0, 2.0, -2.0, -2.0]], [1, -1, 1, -1]),
        ("rem", [[7.5, -7.5], 2.0], [1.5, -1.5]),
    ],
)  # fmt: skip
def test_functions_of_arrays(name: str, arguments: Sequence[Any], expected: Any) -> None:
    found = ARRAYS[name](*(value(each) for each in arguments))
    assert numbers(found) == pytest.approx(np.asarray(expected, dtype=float))
    assert found.dimensions == np.shape(expected)


def test_an_operator_on_arrays_and_on_a_scalar_with_one() -> None:
    assert numbers(elementwise("Sub", value(MATRIX), value(MATRIX * 2))) == pytest.approx(-MATRIX)
    assert numbers(elementwise("Sub", value(3.0), value(MATRIX))) == pytest.approx(3 - MATRIX)
    assert numbers(elementwise("Mul", value(MATRIX), value(2.0))) == pytest.approx(2 * MATRIX)
    assert elementwise("Add", value(1.0), value(2.0)).scalar is const(3.0)
    with pytest.raises(UnsupportedError, match="array in place of a number"):
        _ = value(MATRIX).scalar


@pytest.mark.parametrize(
    ("subscripts", "expected"),
    [
        ([2.0], SQUARE[1]),
        ([2.0, 3.0], SQUARE[1, 2]),
        ([None, 1.0], SQUARE[:, 0]),
        ([3.0, None], SQUARE[2]),
        ([[3.0, 1.0]], SQUARE[[2, 0]]),
        ([[3.0, 1.0], [2.0, 3.0]], SQUARE[np.ix_([2, 0], [1, 2])]),
        ([None, None], SQUARE),
        ([], SQUARE),
    ],
)
def test_elements_of_an_array(subscripts: Sequence[Any], expected: Any) -> None:
    """Rows first, numbers from 1; None is the whole of a dimension."""
    given = [None if each is None else value(each) for each in subscripts]
    found = indexed(value(SQUARE), given)
    assert numbers(found) == pytest.approx(np.asarray(expected))
    assert found.dimensions == np.shape(expected)


@pytest.mark.parametrize("number", [0, 4, -1])
def test_an_index_outside_is_refused(number: int) -> None:
    with pytest.raises(UnsupportedError, match=f"the index {number} of an array of 3"):
        indexed(value(SQUARE), [value(number)])


def test_an_index_that_moves_chooses() -> None:
    """Not a number where it is none of the array."""

    def chosen(e: Expr, number: float) -> float:
        if e.kind == "const":
            return e.value
        condition, yes, no = e.args
        assert condition is apply("Eq", parameter(0), condition.args[1])
        return chosen(yes if condition.args[1].value == number else no, number)

    found = indexed(value(VECTOR), [Value([parameter(0)])])
    assert found.dimensions == ()
    assert [chosen(found.scalar, n) for n in (1, 2, 3)] == VECTOR.tolist()
    assert math.isnan(chosen(found.scalar, 4))
    assert math.isnan(chosen(found.scalar, 0))


def test_a_size_has_to_be_known() -> None:
    assert whole(const(3.0)) == 3
    with pytest.raises(UnsupportedError, match="that moves"):
        whole(parameter(1))


# --- messages


def conversion(source: str, **options: float | None) -> dict[str, Any]:
    given = {name: None if v is None else {"Real": {"value": v}} for name, v in options.items()}
    return {"Conversion": {"source": source, "value": [], "format": {"Options": given}}}


@pytest.mark.parametrize(
    ("part", "text"),
    [
        (conversion("Real"), "%.6g"),
        (conversion("Real", significant_digits=3), "%.3g"),
        (conversion("Real", significant_digits=3, minimum_length=9), "%-9.3g"),
        (conversion("Real", minimum_length=9, left_justified=0.0), "%9.6g"),
        (conversion("Real", minimum_length=9, left_justified=1.0), "%-9.6g"),
        (conversion("Real", minimum_length=0, left_justified=1.0), "%.6g"),
        (conversion("Integer"), "%.0f"),
        (conversion("Integer", minimum_length=4), "%-4.0f"),
        (conversion("Integer", minimum_length=4, left_justified=0.0), "%4.0f"),
        (conversion("Boolean"), "%s"),
        (conversion("Boolean", minimum_length=5, left_justified=0.0), "%5s"),
        (conversion("Boolean", minimum_length=5), "%-5s"),
        (conversion("Boolean", minimum_length=7, left_justified=1.0), "%-7s"),
        (conversion("Integer", minimum_length=0, left_justified=1.0), "%.0f"),
        (conversion("Real", significant_digits=None), "%.6g"),
        ({"Text": "at 100 % of %s"}, "at 100 %% of %%s"),
    ],
)
def test_a_value_in_a_message(part: dict[str, Any], text: str) -> None:
    """String(r) has 6 significant digits and is left-justified (Modelica 3.6, 3.7.1.1)."""
    action = {"message": {"parts": [{"Text": "x = "}, part, {"Text": " m"}]}}
    got, values = read_message(action, lambda _program: parameter(3))
    assert got == f"x = {text} m"
    kind = part.get("Conversion", {}).get("source")
    assert values == ([] if kind is None else [(kind, parameter(3))])


@pytest.mark.parametrize(
    "part",
    [
        conversion("String"),
        {"Conversion": {"source": "Real", "value": [], "format": {"Format": "5.2f"}}},
    ],
)
def test_another_part_of_a_message_is_refused(part: dict[str, Any]) -> None:
    with pytest.raises(UnsupportedError):
        read_message({"message": {"parts": [part]}}, lambda _program: parameter(3))


def test_a_format_that_is_no_number_is_refused() -> None:
    part = conversion("Real")
    part["Conversion"]["format"]["Options"]["minimum_length"] = {"Name": "n"}
    with pytest.raises(UnsupportedError, match="not a number"):
        read_message({"message": {"parts": [part]}}, lambda _program: parameter(3))


def test_a_start_value_that_equations_decide_agrees_within_a_millionth() -> None:
    found = start_check(variable(2), None)
    assert found.condition is apply("Gt", apply("Abs", variable(2)), const(1e-6))
    assert (found.kind, found.at_start, found.values) == ("assert", True, [])


# --- builds


def test_platforms_of_a_build() -> None:
    """This one where none is asked for; each once; both machines of macOS share a folder in 2.0."""
    here = this_platform().name
    mac = ["x86_64-darwin", "aarch64-darwin"]
    assert [each.name for each in _targets((), "3.0")] == [here]
    assert [each.name for each in _targets((), "2.0")] == [here]
    assert [each.name for each in _targets((mac[1], here, mac[1]), "3.0")] == [mac[1], here]
    for asked in mac:
        assert {each.name for each in _targets((asked,), "2.0")} == set(mac)
    assert {each.name for each in _targets((here, mac[0]), "2.0")} == {here, *mac}
    with pytest.raises(BuildError, match="platform solaris is not known"):
        _targets((here, "solaris"), "3.0")
    alone = next((each for each in PLATFORMS.values() if not each.fmi2_folder), None)
    if alone is not None:
        with pytest.raises(BuildError, match=r"FMI 2\.0 has no"):
            _targets((alone.name,), "2.0")


def test_the_name_of_an_fmu_in_the_cache(tmp_path: Path) -> None:
    """The last word of its model and 24 digits; another option is another file."""
    model = MODELS[0]
    last = model.rpartition(".")[2]
    places = [
        place_in_cache(model, tmp_path),
        place_in_cache(model, tmp_path, fmi="2.0"),
        place_in_cache(MODELS[1], tmp_path),
    ]
    assert len(set(places)) == 3
    assert {place.parent for place in places} == {tmp_path}
    for place in places[:2]:
        name, _, key = place.stem.rpartition("-")
        assert (name, len(key), place.suffix) == (last, 24, ".fmu")
    for options, words in (
        ({"fmi": "1.0"}, r"FMI version 1\.0 is not known"),
        ({"compiler": "tcc"}, "compiler tcc is not known"),
    ):
        with pytest.raises(BuildError, match=words):
            place_in_cache(model, tmp_path, **options)  # type: ignore[arg-type]
    with pytest.raises(BuildError, match="no model AxisRig"):
        place_in_cache("AxisRig.Nothing", tmp_path)


def test_the_internal_step_of_a_model() -> None:
    assert _step_s("Some.Model", None) == DEFAULT_STEP_S == 50e-6
    assert _step_s("Some.Model", 1e-3) == _step_s(MODELS[0], 1e-3) == 1e-3


def test_an_archive_depends_on_its_files_alone(tmp_path: Path) -> None:
    """In the order of their names, with the date, the system and the rights of none."""
    archives = []
    for order in (("b/two.txt", "a.txt"), ("a.txt", "b/two.txt")):
        root = tmp_path / order[0].replace("/", "-")
        for name in order:
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(name, encoding="utf-8")
        (root / "a.txt").chmod(0o600 if order[0] == "a.txt" else 0o644)
        packed = tmp_path / f"{root.name}.zip"
        _pack(root, packed)
        archives.append(packed.read_bytes())
    assert archives[0] == archives[1]
    assert archives[0].index(b"a.txt") < archives[0].index(b"b/two.txt")
