"""Which variables a PLC program uses: a text anywhere counts, and a name that it computes."""

import pytest

from axisrig.bench.campaign.used_variables import Used, _in_plc_program


@pytest.mark.parametrize(
    ("body", "all_may"),
    [
        ('hli.ve["A"] = 1', False),
        ('x = hli.ve.get("A", 0)', False),
        ('x = hli.ve.get("A")', False),
        ('x = "A" in hli.ve', False),
        ('x = "A" not in hli.ve', False),
        ('x = "A" == hli.ve', False),
        ('NAME = "A"', False),
        # What it reads is known when it runs only
        ("hli.ve[name] = 1", True),
        ("hli.ve[f'{name}'] = 1", True),
        ("x = hli.ve.get(name, 0)", True),
        ("x = hli.ve.get()", True),
        ("x = hli.ve.pop('A')", True),
        ("x = name in hli.ve", True),
        ("for name in hli.ve: pass", True),
        ("use(hli.ve)", True),
        ('hli.ve["A"] = hli.ve[name]', True),
        ("x = hli.ax[name]", False),
        ("x = (", True),
    ],
)
def test_a_name_that_is_computed_may_be_any(body: str, all_may: bool) -> None:
    names, found = _in_plc_program(f"def cycle(inputs, hli, name, use):\n    {body}\n".encode())
    assert found is all_may
    assert ("A" in names) is ("A" in body.replace("ax", ""))


def test_a_text_counts_with_and_without_its_head() -> None:
    names, _ = _in_plc_program(b'A = {"V.E.FEED": 1, "STEP": 2.5, 3: None}')
    assert sorted(names) == ["FEED", "STEP"]


def test_a_column_is_used_by_its_name_in_any_case() -> None:
    some = Used(frozenset({"FEED"}), all_may=False)
    assert [some.has(f"plc:V.E.{name}") for name in ("FEED", "feed", "FEE")] == [True, True, False]
    assert Used(frozenset(), all_may=True).has("plc:V.E.FEE")
