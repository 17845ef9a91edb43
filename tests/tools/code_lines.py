"""Lines of code of what a name stands for: `python -m tests.tools.code_lines sercos profidrive`.

Of all modules of the product that have the name in their path. Docstrings, comments, blank and
import lines do not count; a module that several names find counts with the first one.
"""

import ast
import io
import sys
import tokenize
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[2]
ROOMS = ("kernel", "bench", "reports", "fmus")
NO_CODE = {
    tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT,
    tokenize.ENDMARKER,
}  # fmt: skip


def lines_of(text: str) -> int:
    """Return how many lines of a module are code."""
    left_out: set[int] = set()
    for node in ast.walk(ast.parse(text)):
        is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        if is_text or isinstance(node, ast.Import | ast.ImportFrom):
            left_out.update(range(node.lineno, (node.end_lineno or node.lineno) + 1))  # type: ignore[attr-defined]
    code: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in NO_CODE:
            code.update(range(token.start[0], token.end[0] + 1))
    return len(code - left_out)


def counts(names: Sequence[str]) -> dict[str, int]:
    """Return the lines of code of each name."""
    modules = [path for room in ROOMS for path in (ROOT / room / "axisrig").rglob("*.py")]
    found = dict.fromkeys(names, 0)
    for path in modules:
        place = path.relative_to(ROOT).as_posix()
        name = next((name for name in names if name in place), None)
        if name is not None:
            found[name] += lines_of(path.read_text("utf-8"))
    return found


if __name__ == "__main__":
    for name, count in (found := counts(sys.argv[1:])).items():
        print(f"{count:6} {name}")
    print(f"{sum(found.values()):6} all")
