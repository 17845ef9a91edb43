"""Program text with places: blanks what is no code and cuts the rest into blocks.

Comments, line continuation and line breaks inside brackets become blanks of the same length.
What is left is one block per line, and each position in it is the position in the file.
"""

import re
from bisect import bisect_right
from collections.abc import Iterator
from pathlib import Path

from kernel.errors import UserError

# Deeper nesting is a typing error, and the builder of the syntax tree recurses per level.
BRACKET_DEPTH_MAX = 20

_SPECIAL = re.compile(r'["();\[\]\\\n]')
_CONTINUATION = re.compile(r"\\[ \t]*(?:[;(][^\n]*)?\n(?:[ \t]*[Nn][ \t]*[0-9]+)?")
_NUMBERED_LINE = re.compile(r"[ \t]*[Nn][ \t]*[0-9]")
_FOUND = re.compile(r"[A-Za-z0-9_.]+|[^ \t\n]|$")


class Source:
    """One program text.

    text: the text with line feeds only. code: the same length, blanked (see the module).
    Raises UserError for a bracket or a string that is not closed, and for a stray `]` or `\\`.
    """

    def __init__(self, text: str, file: str | Path | None) -> None:
        self.file = None if file is None else str(file)
        self.text = text.replace("\r\n", "\n").replace("\r", "\n")
        self._line_starts = [0, *(found.end() for found in re.finditer("\n", self.text))]
        self.code = self._blank()

    def place(self, offset: int) -> tuple[int, int]:
        """Give line and column, both from 1, of an offset."""
        line = bisect_right(self._line_starts, offset)
        return line, offset - self._line_starts[line - 1] + 1

    def error(
        self,
        message: str,
        offset: int,
        *,
        value: object = None,
        allowed: object = None,
        hint: str | None = None,
    ) -> UserError:
        """Make the error of a place; `allowed` is a text or an iterable of names."""
        line, column = self.place(offset)
        return UserError(
            message,
            file=self.file,
            line=line,
            column=column,
            value=value,
            allowed=allowed,  # type: ignore[arg-type]
            hint=hint or None,
        )

    def found(self, offset: int) -> str:
        """Give what a reader sees at an offset: a word or one sign, empty at the end of a line."""
        match = _FOUND.match(self.code, offset)
        return match.group() if match else ""

    def blocks(self) -> Iterator[tuple[int, int]]:
        """Give begin and end of every block that holds code, without the blanks around it."""
        for match in re.finditer(r"[^ \t\n][^\n]*", self.code):
            yield match.start(), match.start() + len(match.group().rstrip(" \t"))

    def block_text(self, begin: int, end: int) -> str:
        """Give a block as written, on one line."""
        return re.sub(r"\s*\n\s*", " ", self.text[begin:end]).strip()

    def _blank(self) -> str:
        out = list(self.text)
        opened: list[int] = []
        offset = 0
        while match := _SPECIAL.search(self.text, offset):
            begin = match.start()
            end = self._element_end(begin, opened)
            # Code stays; a line feed that ends a block stays as the mark between blocks.
            keeps = match.group() in '"[])' or (match.group() == "\n" and not opened)
            if not keeps:
                out[begin:end] = " " * (end - begin)
            offset = end
        if opened:
            raise self._not_closed(opened[-1])
        return "".join(out)

    def _element_end(self, begin: int, opened: list[int]) -> int:
        """Give the end of the element that begins here; keep the list of open brackets."""
        sign = self.text[begin]
        if sign == '"':
            return self._string_end(begin)
        if sign == ";":
            return self._line_end(begin)
        if sign == "(":
            return self._comment_end(begin)
        if sign == "\\":
            return self._continuation_end(begin)
        if sign == "[":
            opened.append(begin)
            if len(opened) > BRACKET_DEPTH_MAX:
                raise self.error(
                    "brackets are nested too deep", begin, allowed=f"{BRACKET_DEPTH_MAX} levels"
                )
        elif sign == "]":
            if not opened:
                raise self.error("no bracket is open here", begin, value="]")
            opened.pop()
        elif sign == "\n" and opened and _NUMBERED_LINE.match(self.text, begin + 1):
            # A block number on the next line shows that the bracket was forgotten, not continued.
            raise self._not_closed(opened[-1])
        return begin + 1

    def _not_closed(self, offset: int) -> UserError:
        return self.error("bracket is not closed in its block", offset, value="[", allowed="]")

    def _line_end(self, begin: int) -> int:
        end = self.text.find("\n", begin)
        return len(self.text) if end < 0 else end

    def _string_end(self, begin: int) -> int:
        end = self.text.find('"', begin + 1)
        if end < 0 or end > self._line_end(begin):
            raise self.error(
                "text is not closed on its line",
                begin,
                value=self.text[begin : begin + 20].split("\n")[0],
                allowed='"',
            )
        return end + 1

    def _comment_end(self, begin: int) -> int:
        """A comment nests and ends with its bracket or with the line, whichever comes first.

        Source: programming manual, comments of a block.
        """
        depth = 0
        for match in re.finditer(r"[()\n]", self.text[begin : self._line_end(begin)]):
            depth += 1 if match.group() == "(" else -1
            if depth == 0:
                return begin + match.end()
        return self._line_end(begin)

    def _continuation_end(self, begin: int) -> int:
        r"""`\` ends a line; the next one goes on and may carry a block number of its own.

        Source: programming manual, line break in a block.
        """
        match = _CONTINUATION.match(self.text, begin)
        if match is None:
            raise self.error(
                "the block goes on with a line break after this sign only",
                begin,
                value="\\",
                allowed="end of the line, with a further line after it",
            )
        return match.end()
