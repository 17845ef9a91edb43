"""The order of the verdicts and what the shell gets to see."""

import itertools

import pytest

from axisrig.bench.plan.verdict import Verdict, exit_code, worst

ORDER = ["pass", "marginal", "inconclusive", "fail", "aborted", "error"]


def test_the_order_is_that_of_the_design() -> None:
    assert [v.word for v in sorted(Verdict)] == ORDER


def test_the_worst_verdict_wins_in_every_pair() -> None:
    for a, b in itertools.product(ORDER, repeat=2):
        expected = ORDER[max(ORDER.index(a), ORDER.index(b))]
        assert worst([Verdict.of(a), Verdict.of(b)]).word == expected


def test_nothing_judged_is_never_a_pass() -> None:
    assert worst([]) == Verdict.ERROR


@pytest.mark.parametrize(("word", "code"), list(zip(ORDER, [0, 0, 3, 1, 4, 4], strict=True)))
def test_exit_codes(word: str, code: int) -> None:
    assert exit_code(Verdict.of(word)) == code


def test_every_verdict_has_its_own_glyph_and_colour() -> None:
    assert len({v.glyph for v in Verdict}) == len({v.colour for v in Verdict}) == len(ORDER)


def test_an_unknown_word_is_a_defect() -> None:
    with pytest.raises(KeyError):
        Verdict.of("passed")
