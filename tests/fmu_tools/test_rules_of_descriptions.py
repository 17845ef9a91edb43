"""Rules of the FMI standard by what fmpy says, names, and how long a large description takes."""

import inspect
import re
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from fmpy import read_model_description, validation
from tests.fmu_tools.described import texts, variable

from axisrig.bench.tools.fmu import examine
from axisrig.bench.tools.fmu.stages import STATE_BOUND, _compared
from axisrig.bench.tools.fmu.stepped_instance import Reading, largest_share
from axisrig.kernel.cosim.fmi.fmu import load_fmu, read_description
from axisrig.kernel.cosim.fmi.rules import bad_names, by_rule, rules
from axisrig.kernel.cosim.fmi.variable_index import by_name


def test_every_pattern_is_in_what_fmpy_says() -> None:
    """A new fmpy with other words fails here; the schema is checked by lxml."""
    source = inspect.getsource(validation)
    strange = [r.name for r in rules() if not re.search(r.pattern.pattern.replace("^", ""), source)]
    assert strange == ["schema"]


def test_only_names_that_are_there_twice_keep_an_fmu_out() -> None:
    assert [rule.name for rule in rules() if not rule.runs] == ["unique-names"]
    assert len({rule.name for rule in rules()}) == len(rules())


def test_problems_are_counted_by_their_rule() -> None:
    missing = [f'Variable "{name}" (line 3) has no start value.' for name in "ab"]
    found = by_rule([missing[0], "something else", missing[1]])
    assert {rule.name: problems for rule, problems in found.items()} == {
        "start-value": missing,
        "other": ["something else"],
    }


@pytest.mark.parametrize(
    ("name", "structured", "flat"),
    [
        ("x", True, True),
        ("body.part[3].x", True, True),
        ("a[1,2].b", True, True),
        ("der(body.x)", True, True),
        ("der(x,2)", True, True),
        ("'odd name + 1'.x", True, True),
        (r"'it\'s'", True, True),
        ("two words", False, True),
        ("3d", False, True),
        ("x.", False, True),
        ("a[1", False, True),
        ("der(x", False, True),
        ("a\tb", False, False),
        ("a\nb", False, False),
    ],
)
def test_names_by_the_convention(name: str, structured: bool, flat: bool) -> None:
    """fmpy, whose parser is slow, finds the same."""
    for convention, is_good in (("structured", structured), ("flat", flat)):
        one = SimpleNamespace(name=name, sourceline=7)
        described: Any = SimpleNamespace(
            variableNamingConvention=convention, modelVariables=[variable("y", sourceline=1), one]
        )
        found = list(bad_names(described))
        assert [f'"{name}" (line 7)' in text for text in found] == [True] * (not is_good)
        assert bool(validation._validate_variable_names(described)) is not is_good


@pytest.mark.parametrize("convention", [None, "", "flat"])
def test_without_a_convention_names_are_flat(convention: str | None) -> None:
    """The default of the attribute, FMI 3.0.2 section 2.4.1."""
    described: Any = SimpleNamespace(
        variableNamingConvention=convention,
        modelVariables=[variable(name, sourceline=7) for name in ("3d", "x.", "a\tb")],
    )
    assert list(bad_names(described)) == [
        '"a\tb" (line 7) is not a legal variable name for naming convention "flat".'
    ]


@pytest.mark.long
def test_a_hundred_thousand_names_take_less_than_a_second() -> None:
    described: Any = SimpleNamespace(
        variableNamingConvention="structured",
        modelVariables=[SimpleNamespace(name=f"b.p[{n}].x", sourceline=n) for n in range(100_000)],
    )
    begin = time.process_time()
    assert list(bad_names(described)) == []
    assert time.process_time() - begin < 1.0


def test_a_description_is_read_once_and_sorted_once(
    ideal_axis: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What takes seconds for 100 000 variables: reading, judging, and an index for instances."""
    path = ideal_axis()
    read: list[str] = []

    def reading(folder: str, **options: Any) -> Any:
        read.append(folder)
        return read_model_description(folder, **options)

    monkeypatch.setattr("fmpy.read_model_description", reading)
    read_description.cache_clear()
    assert examine.examine(path).can_run
    assert len(read) == 1
    first, second = load_fmu(path, "a"), load_fmu(path, "b")
    assert len(read) == 1
    assert by_name(first.description) is by_name(second.description)
    first.close()
    second.close()


# ---- Clocks and event mode


@pytest.mark.parametrize(
    ("clock", "has", "level", "text"),
    [
        (True, "true", "warn", "it needs event mode, which is not there: clocks are not ticked: c"),
        (True, "false", "warn", "it needs event mode"),
        (False, "true", "ok", "it has event mode and no clocks"),
        (False, "false", "", ""),
    ],
)
def test_event_mode_that_is_needed_and_one_that_is_not(
    clock: bool, has: str, level: str, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(examine, "_units", lambda *_: [])
    variables = [variable("y", causality="output")]
    variables += [variable("c", type="Clock")] if clock else []
    described: Any = SimpleNamespace(
        modelVariables=variables, coSimulation=SimpleNamespace(hasEventMode=has)
    )
    found = [t for t in texts(examine._variables(described), level) if "event mode" in t]
    assert len(found) == bool(level)
    assert all(one.startswith(text) for one in found)


# ---- State: amount and bound


def readings(*values: float) -> list[Reading]:
    return [Reading(n * 1_000_000, repr(v).encode(), ((v,),)) for n, v in enumerate(values, 1)]


@pytest.mark.parametrize(
    ("again", "share", "level"),
    [
        ((1.0, -2.0), 0.0, "ok"),
        ((1.0 + 2e-10, -2.0), 1e-10, "warn"),
        ((1.0, -2.0 + 4e-9), 2e-9, "FAIL"),
        ((1.0, 2.0), 2.0, "FAIL"),
        ((1.0,), float("inf"), "FAIL"),
        ((1.0, float("nan")), float("inf"), "FAIL"),
    ],
)
def test_what_a_restored_state_differs_by_has_an_amount_and_a_bound(
    again: tuple[float, ...], share: float, level: str
) -> None:
    """The range of the output is 2, its largest amount."""
    first, other = readings(1.0, -2.0), readings(*again)
    outputs = [variable("way")]
    assert largest_share(first, other, outputs) == pytest.approx(share, rel=1e-6)
    trial: Any = SimpleNamespace(outputs=outputs)
    found = _compared("state", "restored", first, other, trial)
    assert found.level == level
    if level != "ok":
        assert f"by {share:.1e} of the range of an output, bound {STATE_BOUND:g}" in found.text


@pytest.mark.parametrize("order", [1, -1])
def test_the_output_that_differs_most_counts_whichever_it_is(order: int) -> None:
    """A tenth of the range of the one, a fiftieth of that of the other, which is larger."""
    pairs = [(10.0, 9.0), (500.0, 490.0), (1.0, 1.0)][::order]
    one, other = (
        [Reading(1, repr(values).encode(), tuple((value,) for value in values))]
        for values in zip(*pairs, strict=True)
    )
    outputs = [variable(name) for name in "abc"]
    assert largest_share(one, other, outputs) == pytest.approx(0.1)


def test_what_is_no_number_has_no_bound() -> None:
    one, other = (Reading(1, repr(v).encode(), ((v,),)) for v in (True, False))
    assert largest_share([one], [other], [variable("on")]) == float("inf")
    assert largest_share([one], [one], [variable("on")]) == 0
