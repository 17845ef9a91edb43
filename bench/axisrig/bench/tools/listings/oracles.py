"""Lists the closed forms that checks are compared with, as their docstrings have them."""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib import resources
from importlib.resources.abc import Traversable
from textwrap import fill

from axisrig.kernel.errors import UserError, nearest

_PACKAGE = "axisrig.bench.oracles"
_ORIGIN = re.compile(r"(?:Source|Sources|Derivation|Definition)s?:.*", re.DOTALL)


@dataclass(frozen=True)
class Oracle:
    """A closed form. place: its room and module, `distance.stability`. text: its docstring.

    origin: where it comes from, of its own docstring or else of its module: what is after `Source:`
    or `Derivation:`, else all that the module says of itself.
    """

    place: str
    name: str
    text: str
    origin: str


def oracles() -> list[Oracle]:
    """Return the public functions of `bench.oracles`, in the order of their modules."""
    found = []
    for place, source in _modules(resources.files(_PACKAGE), ""):
        tree = ast.parse(source)
        about = ast.get_docstring(tree) or ""
        of_module = _origin(about) or " ".join(about.split())
        for node in tree.body:
            if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
                text = ast.get_docstring(node) or ""
                found.append(Oracle(place, node.name, text, _origin(text) or of_module))
    return found


def oracle_listing(word: str | None = None) -> str:
    """Describe all closed forms in short, or whole those with a word in name, text or source.

    Raises UserError for a word that none has.
    """
    every = oracles()
    if word is None:
        lines = ["Closed forms that checks are compared with; axisrig oracles NAME shows one."]
        for place in dict.fromkeys(oracle.place for oracle in every):
            lines += ["", place]
            of_module = [oracle for oracle in every if oracle.place == place]
            lines += [f"  {one.name:<28} {_first(one.text)}" for one in of_module]
            origins = dict.fromkeys(one.origin for one in of_module)
            lines += [
                fill(text, 96, initial_indent="  ", subsequent_indent="  ") for text in origins
            ]
        return "\n".join(lines)
    low = word.lower()
    named = [one for one in every if low in (one.name, f"{one.place}.{one.name}")]
    fitting = named or [one for one in every if low in _words(one)]
    if not fitting:
        names = [oracle.name for oracle in every]
        raise UserError("no closed form has this word", value=word, allowed=nearest(word, names))
    blocks = []
    for one in fitting:
        own = "" if one.origin in one.text else f"\n\n{one.origin}"
        blocks.append(f"{one.place}.{one.name}\n\n{one.text}{own}")
    return "\n\n".join(blocks)


def _words(one: Oracle) -> str:
    return f"{one.place}.{one.name} {one.text} {one.origin}".lower()


def _modules(folder: Traversable, above: str) -> Iterator[tuple[str, str]]:
    for item in sorted(folder.iterdir(), key=lambda entry: entry.name):
        name = item.name
        if item.is_dir() and name != "__pycache__":
            yield from _modules(item, f"{above}{name}.")
        elif name.endswith(".py") and name != "__init__.py":
            yield f"{above}{name.removesuffix('.py')}", item.read_text(encoding="utf-8")


def _origin(text: str) -> str:
    found = _ORIGIN.search(text)
    return " ".join(found[0].partition("\n\n")[0].split()) if found else ""


def _first(text: str) -> str:
    """The first paragraph in one line."""
    return " ".join(text.partition("\n\n")[0].split())
