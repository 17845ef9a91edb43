"""What the runtime does not hold: a model with it stops the build instead of going wrong."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from axisrig.fmus.reading.classes import used_classes
from axisrig.fmus.reading.errors import BuildError
from axisrig.fmus.reading.expressions import Expr
from axisrig.fmus.reading.ir import Ir, Source


def refuse_unsupported(ir: Ir) -> None:
    """Stop at every part of the representation that nothing here acts on.

    Raises BuildError with the place of the construct where the compiler gives it.
    """
    solve, temporal = ir.solve, ir.dae["systems"]["temporal"]
    layout, events = solve["solve_layout"], solve["events"]
    discrete = solve["discrete"]
    clocked = [b for b in layout["pre_param_bindings"] if b["clock_schedule"] is not None]
    mass = solve["artifacts"]["continuous"]["mass_matrix"]["kind"]
    refused: Sequence[tuple[object, str | None, str]] = (
        (clocked, None, "previous() on a clock is"),
        (layout["terminal_event_parameter_index"] is not None, "terminal", "terminal() is"),
        (temporal["delays"], "delay", "delay() is"),
        (temporal["terminals"], "terminal", "terminal() is"),
        (temporal["previous"], "previous", "previous() is"),
        (events["scheduled_root_conditions"], None, "a scheduled root condition is"),
        (mass != "identity", None, "a mass matrix is"),
    )
    for found, word, message in refused:
        if found:
            raise ir.error(_find(ir, word), f"{message} not supported")
    spans = [program.get("span") for program in _programs(discrete)]
    if len(spans) != len(discrete["update_targets"]):
        raise ir.error(None, "discrete equations and their targets do not match")
    named = [binding.get("P") for binding in solve["layout"]["bindings"].values()]
    for target, observed, span in zip(
        discrete["update_targets"], discrete["observation_refresh"], spans, strict=True
    ):
        if observed and target.get("P", -1) in named:
            message = "a discrete variable that changes without an event is not supported"
            raise ir.error(span, message)


def _programs(discrete: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    """The program of each update target, in the order of the targets."""
    return [
        program
        for plan in ("rhs_plan", "guarded_assignment_plan")
        for program in discrete[plan]["programs"]
        for _ in range(program["output_count"])
    ]


def _find(ir: Ir, word: str | None) -> Mapping[str, int] | None:
    """The span of the first use of a built-in function in the classes of the model."""
    if word is None:
        return None
    files = {number: text for number, (_, text) in ir.files.items()}
    for body in used_classes(files, ir.model):
        found = re.search(rf"\b{word}\s*\(", body.text)
        if found:
            before = files[body.number][: body.offset + found.start()]
            return {"source": body.number, "start": len(before.encode())}
    return None


def refuse_unknown_slots(
    ir: Ir, rows: Iterable[tuple[Expr, Source | None]], known: set[int]
) -> None:
    """Stop at values of p that nothing computes: the compiler means something not known here.

    Raises BuildError with the place of the equation.
    """
    for value, place in rows:
        for leaf in value.leaves():
            if leaf.kind == "p" and leaf.index not in known:
                raise at(ir, place, "an internal value of the compiler is not supported")


def refuse_undetermined(ir: Ir, determined: set[int]) -> None:
    """Stop at discrete variables that no equation computes: the compiler has dropped theirs.

    It does so with equations between whole arrays of Boolean and Integer outside when-clauses.
    determined: the slots of p that some row computes.
    Raises BuildError with the place of the declaration.
    """
    bindings = ir.solve["layout"]["bindings"]
    for variable in ir.dae["variables"]:
        slot = bindings.get(variable["name"], {}).get("P")
        if slot is None or variable["role"] not in ("discrete_real", "discrete_value"):
            continue
        first = slot["index"]
        if not determined.issuperset(range(first, first + variable["scalar_count"])):
            span = variable["declaration"].get("span")
            message = f"the compiler lost the equation of {variable['name']}"
            hint = "write it for each element on its own" if variable["scalar_count"] > 1 else ""
            raise ir.error(span, "; ".join(filter(None, (message, hint))))


def at(ir: Ir, place: Source | None, message: str) -> BuildError:
    """A BuildError at a place of the source, or at the model where there is none."""
    if place is None:
        return ir.error(None, message)
    return BuildError(place.file, place.line, message)
