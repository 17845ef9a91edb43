"""What an output depends on at the same instant, by the kind of rows that it is computed by."""

from types import SimpleNamespace
from typing import Any

import pytest
from tests.fmus.test_words_of_models import shown

from axisrig.fmus.reading.expressions import TIME, apply, parameter
from axisrig.fmus.writing.structure import output_dependencies


@pytest.mark.parametrize(
    "kind", ["algebraics", "runtime", "updates", "whens", "conditions", "relations", "previous"]
)
def test_an_output_depends_on_what_it_is_computed_from_by_any_kind_of_row(kind: str) -> None:
    """An output from p[1], and p[1] from an input and another output; what is kept is memory."""

    def row(index: int, value: Any) -> Any:
        return SimpleNamespace(vector="p", index=index, value=value)

    rows: dict[str, Any] = dict.fromkeys(
        ("algebraics", "updates", "whens", "conditions", "relations", "schedules", "previous"), ()
    )
    system: Any = SimpleNamespace(state_count=1, **rows, runtime=[row(2, parameter(1))])
    made = [
        *(shown(name=f"u{n}", causality="input", vector="p", index=3 + n, reference=2 + n)
          for n in range(2)),
        shown(name="y", vector="p", index=2, reference=10),
        shown(name="z", vector="p", index=9, reference=11),
    ]  # fmt: skip
    assert output_dependencies(system, made) == {10: (), 11: ()}
    value = apply("Add", apply("Mul", parameter(3), TIME), parameter(9))
    if kind == "relations":
        system.relations = [SimpleNamespace(memory=1, function=value)]
    elif kind == "previous":
        system.previous, system.runtime = [(1, "p", 7)], [*system.runtime, row(7, value)]
    else:
        setattr(system, kind, [*getattr(system, kind), row(1, value)])
    kept = kind == "previous"
    assert output_dependencies(system, made) == {10: () if kept else (1, 2), 11: ()}
    system.runtime = [*system.runtime, row(9, parameter(4))]
    assert output_dependencies(system, made) == {10: () if kept else (1, 2, 3), 11: (3,)}
