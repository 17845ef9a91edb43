"""What a parameter is called, where a correction leads, and paths that are no parameter."""

from dataclasses import replace

import pytest

from axisrig.kernel.errors import UserError
from axisrig.kernel.parameters import KINDS, Kind, Origin, Parameter, ParameterSet, table
from axisrig.kernel.parameters.table import Correction
from axisrig.kernel.profiles.profidrive.parameters import parameter_error_text, parameter_errors
from axisrig.kernel.profiles.profidrive.words import encoder_error_text, encoder_errors

HERE = Origin("list.lst", 1)


def row(path: str, kind: Kind = "axis") -> Parameter:
    found = table(kind).row(path)
    assert found is not None
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_a_parameter_is_called_by_its_path_and_its_number_where_it_has_one(kind: Kind) -> None:
    for parameter in table(kind).parameters:
        number = f" ({parameter.number})" if parameter.number else ""
        assert parameter.label == f"{parameter.path}{number}"
    assert row("antr.function[i].rd_ident").label == "antr.function[i].rd_ident"
    assert row("kenngr.messachse").label == "kenngr.messachse (P-AXIS-00118)"


def between(correction: Correction, *, is_open: bool = False) -> Parameter:
    """A number from -5 to 7."""
    return replace(
        row("kenngr.dist_ctrl[0].kp"),
        minimum=-5.0, maximum=7.0, is_open=is_open, correction=correction, values=(),
    )  # fmt: skip


@pytest.mark.parametrize(
    ("correction", "value", "corrected"),
    [
        (Correction(1), -6.0, -5.0), (Correction(1), 8.0, 7.0),
        (Correction(1, low=0.0), -6.0, 0.0), (Correction(1, low=2.0), -6.0, 2.0),
        (Correction(1, low=0.0), 8.0, 7.0),
        (Correction(1, is_kept=True), -6.0, -6.0), (Correction(1, is_kept=True), 8.0, 8.0),
        (Correction(1, is_above_only=True), -6.0, None),
        (Correction(1, is_above_only=True), 8.0, 7.0),
    ],
)  # fmt: skip
def test_a_value_out_of_range_becomes_what_its_correction_says(
    correction: Correction, value: float, corrected: float | None
) -> None:
    """0 in place of the limit is a value too."""
    assert between(correction).corrected(value) == corrected
    assert between(correction).corrected("word") is None
    assert replace(between(correction), correction=None).corrected(value) is None


def test_a_limit_that_is_not_allowed_itself_is_corrected() -> None:
    assert between(Correction(1, low=-4.5), is_open=True).corrected(-5.0) == -4.5
    assert not between(Correction(1), is_open=True).is_within(-5.0)
    assert between(Correction(1)).is_within(-5.0)


@pytest.mark.parametrize(
    "path", ["antr.function[i].id", "antr.function[].id", "antr.function.id", "function[0].id"]
)
def test_a_place_of_an_index_is_no_index(path: str) -> None:
    with pytest.raises(KeyError):
        table("axis").find(path)
    with pytest.raises(UserError):
        ParameterSet("axis").load(path, "A", HERE)


@pytest.mark.parametrize("kind", ["axis", "channel"])
def test_every_path_is_found_with_its_last_index_and_not_behind_it(kind: Kind) -> None:
    """Lists of axes and channels have rows whose indices all have a largest value."""
    limited = [row for row in table(kind).parameters
               if len(row.index_max) == row.path.count("[i]") > 0]  # fmt: skip
    assert limited
    for parameter in limited:
        for at in range(len(parameter.index_max)):
            last = list(parameter.index_max)
            assert table(kind).find(filled(parameter.path, last))[0] is parameter
            last[at] += 1
            with pytest.raises(KeyError):
                table(kind).find(filled(parameter.path, last))


def filled(path: str, indices: list[int]) -> str:
    for index in indices:
        path = path.replace("[i]", f"[{index}]", 1)
    return path


@pytest.mark.parametrize("kind", KINDS)
def test_what_has_one_stem_is_together_from_its_first_row_on(kind: Kind) -> None:
    """Whatever rows are between: a group comes where the table has its first one."""
    known = table(kind)
    paths = [row.path.replace("[i]", "[0]") for row in known.parameters]
    stems = [_stem(path) for path in paths]
    wanted = [path for stem in dict.fromkeys(stems) for path in paths if _stem(path) == stem]
    backwards = paths[::-1]
    assert sorted(backwards, key=known.place) == wanted


def _stem(path: str) -> str:
    head, index, _ = path.partition("[0]")
    return head + index


# Words of PROFIdrive errors


def test_an_error_of_an_encoder_has_its_words_or_is_of_the_manufacturer() -> None:
    words = [encoder_error_text(code) for code in encoder_errors().values()]
    assert len(set(words)) == len(words) > 2
    assert "a code of the manufacturer" not in words
    assert encoder_error_text(0x7FFF) == "a code of the manufacturer"


def test_an_error_of_a_parameter_has_its_number_in_two_digits() -> None:
    for code in parameter_errors().values():
        assert parameter_error_text(code).startswith(f"error 0x{code:02X}, ")
    assert parameter_error_text(0x05).startswith("error 0x05, ")
    assert parameter_error_text(0xEE) == "error 0xEE, one of the manufacturer"
