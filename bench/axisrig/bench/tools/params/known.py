"""A list of a control as this bench can read it: lines that it cannot are comments."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from axisrig.bench.rig.contents import guess_kind
from axisrig.kernel.errors import UserError, near_files
from axisrig.kernel.parameters import Kind, read_sections

_TURNS = 9
"""A line may be wrong only as another one is gone: so often it is read again."""


def known_text(path: Path) -> tuple[str, int]:
    """Return the text of a list with each line that is refused as a comment that says why.

    The second value is the number of these lines. Raises UserError for a file that is no list.
    """
    if not path.is_file():
        raise UserError("no such list", file=path, hint=near_files(path.parent, path.name))
    lines = path.read_text(encoding="utf-8-sig", errors="replace").splitlines()
    kind = guess_kind(path)
    refused: dict[int, str] = {}
    for _ in range(_TURNS):
        found = _refused(_text(lines, refused), kind)
        if not found:
            break
        refused |= found
    return _text(lines, refused), len(refused)


def _text(lines: Sequence[str], refused: Mapping[int, str]) -> str:
    """Return the list with the lines that are refused as comments."""
    numbered = enumerate(lines, start=1)
    text = [f"# {line.strip()}  # {refused[n]}" if n in refused else line for n, line in numbered]
    return "\n".join([*text, ""])


def _refused(text: str, kind: Kind) -> dict[int, str]:
    """Return the lines of a list that are refused, with the reason."""
    with TemporaryDirectory(prefix="axisrig-list-") as folder:
        part = Path(folder) / "list.lst"
        part.write_text(text, encoding="utf-8")
        try:
            read_sections(part, kind)
        except UserError as error:
            return {
                one.line: _reason(one) for one in (error, *error.further) if one.line is not None
            }
    return {}


def _reason(error: UserError) -> str:
    return " ".join(error.message.split())
