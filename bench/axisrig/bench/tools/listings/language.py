"""The NC language as text for a reader: words of the tables, and the page docs/nc-language.md."""

from collections.abc import Iterable, Sequence
from importlib import resources

from axisrig.kernel.errors import UserError, nearest
from axisrig.kernel.nc.text.errata import errata
from axisrig.kernel.nc.text.published import published
from axisrig.kernel.nc.text.values import RANKS
from axisrig.kernel.nc.text.words import Keyword, commands, examples, forms, variables, words

# Up to so many commands are shown with their keywords
_FEW = 8
_KINDS = {
    "G": "G functions",
    "M": "M functions",
    "address": "Addresses",
    "function": "Functions of expressions",
    "control": "Control structures",
    "sign": "Calls and signs",
}
_HEAD = """\
# NC language

Made by `axisrig language --markdown` from the grammar and the tables in
`kernel/axisrig/kernel/nc/text`; a test holds it fresh. `axisrig language WORD` shows one word.
Upper and lower case do not differ. A word with `no` under *acts* is read, and the program ends with
alarm 900100 when the machine gets there; `axisrig nc --check FILE` lists such words of a program as
notes.

## Program and block

"""
_EXPRESSIONS = """
## Expressions

Numbers (`10`, `1.5`, `.5`, `0x1F`), texts in `"`, `TRUE` (1) and `FALSE` (0), parameters
(`P10`, `P[expression]`), variables (`V.P.NAME[1]`), functions with their operands in `[ ]`,
groups in `[ ]`. A constant expression is computed when the program is read. Operators, from the
tightest to the loosest; those of one rank from left to right; a sign is applied after a
power (`-2**2` is -4):

| rank | operators |
|---|---|
"""


def language_listing(word: str | None = None) -> str:
    """One line per word, command and variable; or all about those that have a word in them.

    Raises UserError when nothing fits.
    """
    lines = list(_lines())
    if word is None:
        return "\n".join(
            f"{name:<32} {'' if acts else '(-) '}{meaning}" for name, acts, meaning in lines
        )
    wanted = word.upper().lstrip("#")
    exact = [line for line in lines if line[0].upper().lstrip("#") == wanted]
    found = exact or [line for line in lines if wanted in f"{line[0]} {line[2]}".upper()]
    if not found:
        names = [name for name, _, _ in lines]
        raise UserError("no word fits", value=word, allowed=nearest(word, names) or None)
    lines_of_words = []
    for line in found:
        lines_of_words.append(_line(*line))
        if len(found) <= _FEW:
            lines_of_words += _keyword_lines(line[0])
            is_last = [other for other in found if other[0] == line[0]][-1] is line
            lines_of_words += _example_lines(line[0]) if is_last else []  # a word may have two rows
    return "\n".join(lines_of_words)


_MAY_PASS = "; may be passed over"


def _line(name: str, acts: bool, meaning: str) -> str:
    return f"{name:<32} {'' if acts else '(-) '}{meaning}"


def _lines() -> Iterable[tuple[str, bool, str]]:
    for kind in _KINDS:
        for word in words(kind).values():
            yield word.word, word.acts, word.meaning
    for name, table in commands().items():
        yield _shown(name), table[""].acts, table[""].meaning
    for row in variables():
        yield row.name, row.acts, row.meaning
    for name, known in published().items():
        yield name, False, known.meaning + (_MAY_PASS if known.passed_over else "")


def _shown(command: str) -> str:
    """Write the name of a command as a program does."""
    if command.startswith("<axis>"):
        return f"<axis>[{command.removeprefix('<axis>')}]"
    return command if command.startswith("L ") else f"#{command}"


def _keyword_lines(shown: str) -> list[str]:
    table = next((t for name, t in commands().items() if _shown(name) == shown), {})
    return [
        f"    {_keyword(row):<28} {'' if row.acts else '(-) '}{row.meaning}"
        for keyword, row in table.items()
        if keyword
    ]


def _example_lines(shown: str) -> list[str]:
    """Say how a word is used and which page explains it."""
    if shown not in examples():
        return []
    text, page = examples()[shown]
    first, *others = text.splitlines()
    lines = [f"    example: {first}", *(f"             {line}" for line in others)]
    return [*lines, f"    see {page}"]


def _keyword(row: Keyword) -> str:
    if row.kind == "flag":
        return row.keyword
    choice = "|".join(row.allowed.split()) if row.kind == "name" and row.allowed else row.kind
    return f"{row.keyword}={choice}"


def page() -> str:
    """Give the page docs/nc-language.md."""
    parts = [_HEAD, _table(("form", "meaning"), forms()), _EXPRESSIONS]
    ranks = enumerate(reversed(RANKS), start=1)
    parts.append("".join(f"| {rank} | {_code(signs)} |\n" for rank, signs in ranks))
    parts.append("\n`OR` and `AND` mean `||` and `&&`.\n")
    parts += ["\n## Examples\n\n", _table(("word", "example", "explained in"), _example_rows())]
    for kind, title in _KINDS.items():
        parts += [
            f"\n## {title}\n\n",
            _table(("word", "meaning", "acts", "source"), _word_rows(kind)),
        ]
    parts += ["\n## Commands\n", *(_command(name) for name in commands())]
    parts += ["\n## Variables\n\n", _table(("variable", "unit", "meaning", "acts", "source"), [
        (f"`{row.name}`", row.unit, row.meaning, _yes(row.acts), row.source) for row in variables()
    ])]  # fmt: skip
    parts += [_PUBLISHED, _table(("word", "meaning", "passed over, since", "source"), [
        (f"`{word}`", row.meaning, row.passed_over, row.source) for word, row in published().items()
    ])]  # fmt: skip
    parts += [_ERRATA, _table(("printed", "meant", "how", "where", "reason"), [
        (f"`{row.printed}`", f"`{row.meant}`", row.treatment, row.place, row.reason)
        for row in errata()
    ])]  # fmt: skip
    grammar = (
        resources.files("axisrig.kernel.nc.text")
        .joinpath("grammar.lark")
        .read_text(encoding="utf-8")
    )
    rules = grammar.partition("// ---- signs and words")[0].rstrip()
    parts.append(f"\n## Grammar\n\nThe rules of one block (lark, LALR).\n\n```\n{rules}\n```\n")
    return "".join(parts)


_PUBLISHED = """
## Published words that do not act

The maker of the kernel publishes these words too. A block with one is read, its values count for
nothing, and the program ends with 900100 if it gets there. Where the third column has a reason, a
rig may say `pass_over = ["#TIMER"]` in `[language]`: the word then counts for nothing, and every
run says so. `inferred`: what it is for was concluded from its name.

"""
_ERRATA = """
## Errata of the printed manuals

What is printed and what is meant. `refused`: the error of the block names what is meant.
`accepted`: read as what is meant, and `axisrig nc --check` notes it. `elsewhere`: no NC text but
a parameter of a list.

"""


def _word_rows(kind: str) -> list[tuple[str, ...]]:
    lines: list[tuple[str, ...]] = []
    for word in words(kind).values():
        meaning = word.meaning
        if kind == "function":
            meaning += f" ({word.group} operand{'s' if word.group != '1' else ''})"
        elif word.group:
            meaning += f" (group: {word.group})"
        lines.append((f"`{word.word}`", meaning, _yes(word.acts), word.source))
    return lines


def _command(name: str) -> str:
    table = commands()[name]
    own = table[""]
    values = "" if own.kind == "none" else f" Values: {own.kind}, {own.allowed or 'any number'}."
    acts = "" if own.acts else " Does not act."
    text = (
        f"\n### {_shown(name)}\n\n{own.meaning[:1].upper()}{own.meaning[1:]}.{values}{acts}"
        f" Source: {own.source}.\n"
    )
    keywords = [
        (f"`{_keyword(row)}`", row.meaning, _needed(row), _yes(row.acts and own.acts))
        for keyword, row in table.items()
        if keyword
    ]
    if not keywords:
        return text
    return f"{text}\n{_table(('keyword', 'meaning', 'needed', 'acts'), keywords)}"


def _example_rows() -> Iterable[tuple[str, ...]]:
    by_example: dict[tuple[str, str], list[str]] = {}
    for word, example in examples().items():
        by_example.setdefault(example, []).append(word)
    for (text, place), names in by_example.items():
        lines = "<br>".join(f"`{line}`" for line in text.splitlines())
        link = place.removeprefix("docs/")
        yield " ".join(f"`{name}`" for name in names), lines, f"[{link}]({link})"


def _needed(row: Keyword) -> str:
    known = {"yes": "yes", "no": "", "": "", "many": "may repeat"}
    return known.get(row.required, f"one of these ({row.required})")


def _yes(acts: bool) -> str:
    return "yes" if acts else "no"


def _code(signs: Sequence[str]) -> str:
    return " ".join(f"`{sign}`" for sign in signs).replace("|", "\\|")


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [" | ".join(head), "|".join("---" for _ in head)]
    lines += [" | ".join(cell.replace("|", "\\|") for cell in row) for row in rows]
    return "".join(f"| {line} |\n" if line[:3] != "---" else f"|{line}|\n" for line in lines)
