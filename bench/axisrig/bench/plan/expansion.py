"""Cells that stand for several values, and the runs that a row with such cells stands for.

    [a | b]                 a list, also as a part of a cell; `[[` writes a bracket
    300 .. 3000 step 300    both ends, decimal
    log(1, 100, 5)          five values with equal ratios, both ends
    boundary(300, 3000, 1)  ends, the values one step inside them, and the middle: five values
    pairwise(a | b)         a list; all such cells of the row give runs with each pair of values
    lhs(0.1, 0.5)           Latin hypercube over all such cells of the row, `samples` points
    sobol(0.1, 0.5)         Sobol sequence, likewise
    normal(10, 0.2)         mean and standard deviation; one draw for each run, from its seed

Several in a row are a product, the last column fastest; with `expand` = `zip` the first value of
each goes with the first of the others. The points of `lhs` and `sobol` are one list of its own, and
so are the combinations of `pairwise`.
"""

import hashlib
import math
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from zlib import crc32

from axisrig.bench.plan.composition import EMPTY, MeantRow
from axisrig.bench.plan.hints import several_hint
from axisrig.bench.plan.pairwise import pairwise
from axisrig.bench.plan.run_ids import UNSAFE
from axisrig.bench.plan.series import (
    FORMS,
    RUNS_MAX,
    boundary_values,
    decimals,
    log_values,
    number_text,
    range_values,
    too_many,
)
from axisrig.bench.plan.table import Cell

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_RANGE_BEGIN = re.compile(rf"\s*{_NUMBER}\s*\.\.(?!\.)")
_CALL = re.compile(r"(log|boundary|lhs|sobol|normal)\s*\((.*)\)", re.DOTALL)
_PAIRWISE = re.compile(r"pairwise\s*\((.*)\)", re.DOTALL)
_ARGUMENTS = {"log": 3, "boundary": 3, "lhs": 2, "sobol": 2, "normal": 2}
_LABEL_MAX, _LABEL_CUT, _HASH_DIGITS = 60, 40, 8


@dataclass(frozen=True)
class Pattern:
    """A cell taken apart: texts and the lists between them, or one function of a sample.

    parts: texts, and tuples of values; of a range or `log(...)` one tuple. drawn: `lhs`, `sobol`
    or `normal` with its arguments in place of parts. is_paired: of `pairwise`, a single list.
    """

    cell: Cell
    parts: tuple[str | tuple[str, ...], ...] = ()
    drawn: tuple[str, float, float] | None = None
    is_paired: bool = False

    @property
    def lists(self) -> list[tuple[str, ...]]:
        """The lists of the cell, in their order."""
        return [part for part in self.parts if isinstance(part, tuple)]

    def filled(self, values: Sequence[str]) -> str:
        """Write the cell with one value for each list."""
        rest = iter(values)
        text = "".join(part if isinstance(part, str) else next(rest) for part in self.parts)
        return "" if text == EMPTY else text


@dataclass(frozen=True)
class Variant:
    """One run of a row, without its id.

    texts: the cells by column, those with content. swept: column -> its value, of those that hold
    lists. label: their values, as the id of the run shows them. number: counted from 1 over samples
    and repeats; 0 where the row asks for one. drawn: column -> mean and standard deviation.
    """

    texts: Mapping[str, str]
    swept: Mapping[str, str]
    label: str
    number: int
    drawn: Mapping[str, tuple[float, float]]


def parse_cell(cell: Cell, *, is_condition: bool = False) -> Pattern:
    """Take a cell apart. is_condition: only lists hold.

    Raises UserError with the place of the cell for a form that cannot be read.
    """
    text = cell.text
    if is_condition:
        return Pattern(cell, _lists(cell))
    if (pairs := _PAIRWISE.fullmatch(text)) is not None:
        return Pattern(cell, (_paired(cell, pairs[1].strip()),), is_paired=True)
    if _RANGE_BEGIN.match(text):
        return Pattern(cell, (decimals(cell, range_values),))
    if (match := _CALL.fullmatch(text)) is not None:
        name, arguments = match[1], [part.strip() for part in match[2].split(",")]
        if len(arguments) != _ARGUMENTS[name] or not all(
            re.fullmatch(_NUMBER, argument) for argument in arguments
        ):
            raise cell.place.error(
                f"{name} needs {_ARGUMENTS[name]} numbers", value=text, allowed=FORMS
            )
        if name in _SERIES:
            return Pattern(cell, (decimals(cell, _SERIES[name], *arguments),))
        first, second = float(arguments[0]), float(arguments[1])
        if not math.isfinite(first) or not math.isfinite(second):
            raise cell.place.error("the number is too large", value=text)
        if name == "normal" and second < 0.0:
            raise cell.place.error("the standard deviation is negative", value=text)
        if name != "normal" and first >= second:
            raise cell.place.error("the lower limit is not below the upper one", value=text)
        return Pattern(cell, drawn=(name, first, second))
    return Pattern(cell, _lists(cell))


def _lists(cell: Cell) -> tuple[str | tuple[str, ...], ...]:
    """Split a cell into texts and lists."""
    if "[" not in cell.text:
        return (cell.text,)
    text, parts, plain, at = cell.text, list[str | tuple[str, ...]](), "", 0
    while at < len(text):
        if text.startswith("[[", at):
            plain, at = plain + "[", at + 2
        elif text[at] == "[":
            end = text.find("]", at)
            if end < 0:
                raise cell.place.error(
                    "the list is not closed", value=text, hint="[[ writes a bracket"
                )
            parts += [plain, _values(cell, text[at + 1 : end])]
            plain, at = "", end + 1
        else:
            plain, at = plain + text[at], at + 1
    return (*parts, plain)


def _values(cell: Cell, text: str) -> tuple[str, ...]:
    values = tuple(value.strip() for value in text.split("|"))
    if not any(values):
        raise cell.place.error("the list is empty", value=cell.text, allowed=FORMS)
    if not all(values):
        raise cell.place.error(
            "a value of the list is missing", value=cell.text, hint=f"{EMPTY} leaves the cell empty"
        )
    for value in values:
        if "[" in value or _RANGE_BEGIN.match(value) or _CALL.fullmatch(value):
            raise cell.place.error("a list holds plain values", value=value, allowed=FORMS)
    if ";" in text and (hint := several_hint(values[0])) is not None:
        raise cell.place.error("a list has bars between its values", value=cell.text, hint=hint)
    twice = [value for value in values if values.count(value) > 1]
    if twice:
        raise cell.place.error("a value is twice in the list", value=twice[0])
    return values


_SERIES: Mapping[str, Callable[..., tuple[str, ...]]] = {
    "log": log_values,
    "boundary": boundary_values,
}


def _paired(cell: Cell, text: str) -> tuple[str, ...]:
    """Give the values in `pairwise(...)`: a list without its brackets, or what makes one."""
    inside = Cell(text, cell.place)
    if "|" in text:
        return _values(inside, text)
    pattern = parse_cell(inside)
    if pattern.is_paired or pattern.drawn or len(pattern.lists) != 1 or len(pattern.parts) != 1:
        allowed = (
            "pairwise(a | b), pairwise(300 .. 3000 step 300), pairwise(boundary(300, 3000, 1))"
        )
        raise cell.place.error(
            "pairwise(...) holds several values", value=cell.text, allowed=allowed
        )
    return pattern.lists[0]


def variants(
    row: MeantRow,
    expandable: Sequence[str],
    conditions: Sequence[str],
    *,
    repeats: int,
    samples: int | None,
    seed: str,
) -> tuple[int, Iterator[Variant]]:
    """Expand a row: how many runs it stands for, and these.

    expandable: columns that may hold any form. conditions: columns whose cells are conditions.
    samples: the cell, None without one. seed: of `lhs` and `sobol`, the cell.
    Raises UserError with the place for what cannot be expanded, also for more than RUNS_MAX runs.
    """
    is_zip = _is_zip(row)
    patterns = {c: parse_cell(row.cells[c]) for c in expandable if c in row.cells}
    checks = {c: _condition(row.cells[c], is_zip=is_zip) for c in conditions if c in row.cells}
    every = {**patterns, **checks}
    listed = {column: pattern for column, pattern in every.items() if pattern.lists}
    lists = [values for pattern in listed.values() for values in pattern.lists]
    if is_zip:
        _refuse_paired(listed)
        _same_length(listed)
        combinations: Iterator[tuple[str, ...]] = zip(*lists, strict=True) if lists else iter([()])
        count = len(lists[0]) if lists else 1
    else:
        choices = _choices(listed)
        combinations, count = _joined(choices), math.prod(map(len, choices))
    if checks.keys() & listed.keys() and not patterns.keys() & listed.keys():
        column = next(c for c in listed if c in checks)
        raise row.cells[column].place.error(
            "the list of a condition goes with a list of values, and the row has none",
            value=row.cells[column].text,
        )
    sampled = {c: p for c, p in patterns.items() if p.drawn and p.drawn[0] != "normal"}
    points = _points(row, sampled, samples, seed)
    total = count * len(points) * repeats
    if total > RUNS_MAX:
        place = max(listed or every, key=lambda c: len(every[c].lists), default="case")
        raise row.cells[place].place.error(too_many(total), value=row.cells[place].text)
    made = _each(row, every, listed, list(combinations), points, repeats)
    return total, made


_Choice = Mapping[int, str]
"""Values of lists of a row by their numbers."""


def _choices(listed: Mapping[str, Pattern]) -> list[list[_Choice]]:
    """Return what there is to choose from: each list, and those of `pairwise` as one.

    Raises UserError where pairs are too many.
    """
    lists = [(p, values) for p in listed.values() for values in p.lists]
    paired = [number for number, (pattern, _) in enumerate(lists) if pattern.is_paired]
    counts = [len(lists[number][1]) for number in paired]
    if math.prod(sorted(counts)[-2:]) > RUNS_MAX:
        cell = lists[paired[0]][0].cell
        raise cell.place.error(too_many(math.prod(sorted(counts)[-2:])), value=cell.text)
    found: list[list[_Choice]] = []
    for number, (_, values) in enumerate(lists):
        if number not in paired:
            found.append([{number: value} for value in values])
        elif number == paired[0]:
            rows = pairwise(counts)
            found.append(
                [{n: lists[n][1][at] for n, at in zip(paired, row, strict=True)} for row in rows]
            )
    return found


def _joined(choices: Sequence[Sequence[_Choice]]) -> Iterator[tuple[str, ...]]:
    """Yield the values of all lists, in their order, for each combination of choices."""
    for chosen in product(*choices):
        values = {number: value for choice in chosen for number, value in choice.items()}
        yield tuple(values[number] for number in sorted(values))


def _refuse_paired(listed: Mapping[str, Pattern]) -> None:
    for pattern in listed.values():
        if pattern.is_paired:
            raise pattern.cell.place.error(
                "with `zip` the first values go together, with pairwise(...) each pair",
                value=pattern.cell.text,
                hint="leave `expand` empty, or write a list in brackets",
            )


def _each(
    row: MeantRow,
    every: Mapping[str, Pattern],
    listed: Mapping[str, Pattern],
    combinations: Sequence[tuple[str, ...]],
    points: Sequence[Mapping[str, str]],
    repeats: int,
) -> Iterator[Variant]:
    fixed = {column: cell.text for column, cell in row.cells.items()}
    fixed |= {c: p.filled(()) for c, p in every.items() if not p.lists and not p.drawn}
    drawn = {c: p.drawn[1:] for c, p in every.items() if p.drawn and p.drawn[0] == "normal"}
    filled = [_filled(listed, values) for values in combinations]
    inputs = [{c: t for c, t in one.items() if not c.startswith("check:")} for one in filled]
    labels = _labels(inputs)
    is_counted = len(points) > 1 or repeats > 1 or any(points)
    for texts, swept, label in zip(filled, inputs, labels, strict=True):
        for index, (point, _) in enumerate(product(points, range(repeats)), start=1):
            both = {**fixed, **texts, **point}
            number = index if is_counted else 0
            yield Variant({c: t for c, t in both.items() if t}, swept, label, number, drawn)


def _filled(listed: Mapping[str, Pattern], values: tuple[str, ...]) -> dict[str, str]:
    rest = iter(values)
    return {c: p.filled([next(rest) for _ in p.lists]) for c, p in listed.items()}


def _labels(swept: Sequence[Mapping[str, str]]) -> list[str]:
    """Give each combination of values its text in ids; long and equal ones get a hash."""
    plain = ["-".join(UNSAFE.sub("_", text or EMPTY) for text in one.values()) for one in swept]
    # File systems that ignore case would let one run overwrite the other
    folded = [text.casefold() for text in plain]
    counts: dict[str, int] = {}
    for text in folded:
        counts[text] = counts.get(text, 0) + 1
    return [
        text
        if len(text) <= _LABEL_MAX and counts[fold] == 1
        else f"{text[:_LABEL_CUT]}-{_hash(one)}"
        for text, fold, one in zip(plain, folded, swept, strict=True)
    ]


def _hash(swept: Mapping[str, str]) -> str:
    text = "\n".join(f"{column}={value}" for column, value in swept.items())
    return hashlib.sha256(text.encode()).hexdigest()[:_HASH_DIGITS]


def _is_zip(row: MeantRow) -> bool:
    cell = row.cells.get("expand")
    if cell is not None and cell.text not in ("product", "zip"):
        raise cell.place.error(
            "lists cannot go together like this", value=cell.text, allowed=("product", "zip")
        )
    return cell is not None and cell.text == "zip"


def _condition(cell: Cell, *, is_zip: bool) -> Pattern:
    """Take a condition apart; a bracket is a list only where lists go together."""
    if not is_zip and "|" not in cell.text:
        return Pattern(cell, (cell.text.replace("[[", "["),))
    pattern = parse_cell(cell, is_condition=True)
    if pattern.lists and not is_zip:
        raise cell.place.error(
            "a list in a condition needs `zip` in the column `expand`",
            value=cell.text,
            hint="then the first limit goes with the first value; [[ writes a bracket",
        )
    return pattern


def _same_length(listed: Mapping[str, Pattern]) -> None:
    lengths = [
        (len(values), pattern.cell) for pattern in listed.values() for values in pattern.lists
    ]
    for length, cell in lengths:
        if length != lengths[0][0]:
            raise cell.place.error(
                f"the list has {length} values and that of"
                f" {lengths[0][1].place.name or lengths[0][1].place.header} {lengths[0][0]}",
                value=cell.text,
                hint="with `zip` all lists of a row have the same length",
            )


def _points(
    row: MeantRow, sampled: Mapping[str, Pattern], samples: int | None, seed: str
) -> list[dict[str, str]]:
    """Give the points of `lhs` and `sobol`; one without any value where there are none."""
    if not sampled:
        if samples is not None:
            raise row.cells["samples"].place.error(
                "no cell of the row is lhs(...) or sobol(...)", value=str(samples)
            )
        return [{}]
    first = next(iter(sampled.values())).cell
    for column, value in (("samples", samples), ("seed", seed or None)):
        if value is None:
            raise first.place.error(
                "lhs(...) and sobol(...) need the columns samples and seed",
                value=first.text,
                hint=f"{column} is missing",
            )
    if not seed.isdecimal():
        raise row.cells["seed"].place.error(
            "with lhs(...) or sobol(...) the seed is one number", value=seed
        )
    assert samples is not None
    columns = []
    for kind in ("lhs", "sobol"):
        of_kind = {c: p.drawn for c, p in sampled.items() if p.drawn and p.drawn[0] == kind}
        columns += _scaled(kind, of_kind, samples, int(seed))
    in_order = {c: values for wanted in sampled for c, values in columns if c == wanted}
    return [
        dict(zip(in_order, point, strict=True)) for point in zip(*in_order.values(), strict=True)
    ]


def _scaled(
    kind: str, limits: Mapping[str, tuple[str, float, float]], samples: int, seed: int
) -> list[tuple[str, list[str]]]:
    """Draw `samples` points of one kind (scipy.stats.qmc), a list of texts for each column."""
    if not limits:
        return []
    from scipy.stats import qmc  # noqa: PLC0415 - takes half a second

    make = qmc.LatinHypercube if kind == "lhs" else qmc.Sobol
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Sobol without a power of 2: less balanced, not wrong
        unit = make(d=len(limits), seed=seed).random(samples)
    return [
        (column, [number_text(low + (high - low) * float(u)) for u in unit[:, at]])
        for at, (column, (_, low, high)) in enumerate(limits.items())
    ]


def draw(column: str, mean: float, deviation: float, seed: int) -> str:
    """Draw a value of `normal(mean, deviation)`; each column has a sequence of its own."""
    import numpy as np  # noqa: PLC0415 - a plan without it reads without numpy

    generator = np.random.default_rng([seed, crc32(column.encode())])
    return number_text(mean + deviation * float(generator.standard_normal()))
