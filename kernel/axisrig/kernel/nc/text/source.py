"""Program text with places: blanks what is no code and cuts the rest into blocks.

Comments, line continuation and line breaks inside brackets become blanks of the same length.
What is left is one block per line, and each position in it is the position in the file.
"""

import re
from bisect import bisect_right
from collections.abc import Iterator
from pathlib import Path

from axisrig.kernel.errors import UserError, printable

# Deeper nesting is a typing error, and the builder of the syntax tree recurses per level.
BRACKET_DEPTH_MAX = 20
# Signs of a line that an error shows
EXCERPT_WIDTH = 100

_SPECIAL = re.compile(r'["();\[\]\\\n]|#(?=[ \t]*[Cc][Oo][Mm][Mm][Ee][Nn][Tt]\b)')
_OUTSIDE = re.compile(r'["();\[\]\\]|#(?=[ \t]*[Cc][Oo][Mm][Mm][Ee][Nn][Tt]\b)')
_COMMENT_BEGIN = re.compile(r"#[ \t]*COMMENT[ \t]+BEGIN\b", re.IGNORECASE)
_COMMENT_END = re.compile(r"#[ \t]*COMMENT[ \t]+END\b", re.IGNORECASE)
# The path of a global subprogram may hold backslashes
_CALL = re.compile(r"[ \t]*(?:[Nn][ \t]*[0-9]+[ \t]*)?[Ll][ \t]+[^\n]*")
_CONTINUATION = re.compile(r"\\[ \t]*(?:[;(][^\n]*)?\n(?:[ \t]*[Nn][ \t]*[0-9]+)?")
_NUMBERED_LINE = re.compile(r"[ \t]*[Nn][ \t]*[0-9]")
_FOUND = re.compile(r"[A-Za-z0-9_.]+|[^ \t\n]|$")


class Source:
    """One program text.

    text: the text with line feeds only. code: the same length, blanked (see the module).
    faults: a bracket, a string or a comment that is not closed, a stray `]` or `\\`; the line of a
    fault is blanked, so that the blocks after it can be read.
    """

    def __init__(self, text: str, file: str | Path | None) -> None:
        self.file = None if file is None else str(file)
        self.text = text.replace("\r\n", "\n").replace("\r", "\n")
        self._line_starts = [0, *(found.end() for found in re.finditer("\n", self.text))]
        self.faults: list[UserError] = []
        self.code = self._blank()

    def place(self, offset: int) -> tuple[int, int]:
        """Give line and column, both from 1, of an offset."""
        line = bisect_right(self._line_starts, offset)
        return line, offset - self._line_starts[line - 1] + 1

    def offset(self, line: int, column: int) -> int:
        """Give the offset of a line and a column, both from 1."""
        return self._line_starts[line - 1] + column - 1

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
        error = UserError(
            message,
            file=self.file,
            line=line,
            column=column,
            value=value,
            allowed=allowed,  # type: ignore[arg-type]
            hint=hint or None,
        )
        error.excerpt = self.excerpt(line, column)
        return error

    def excerpt(self, line: int, column: int) -> str:
        """Give a line, or the part of a long one around the place, with a caret under it."""
        text, place = self.line(line), column - 1
        begin = max(0, place - EXCERPT_WIDTH // 2) if len(text) > EXCERPT_WIDTH else 0
        shown = printable(text[begin : begin + EXCERPT_WIDTH])
        found = _FOUND.match(text, place)
        width = max(1, min(len(found.group()) if found else 1, len(shown) - (place - begin)))
        margin = f"{line:5} | "
        return f"{margin}{shown}\n{' ' * (len(margin) - 2)}| {' ' * (place - begin)}{'^' * width}"

    def place_of(self, sign: str, begin: int) -> int:
        """Give where a sign is in the block that begins at an offset; its begin without one."""
        end = self.code.find("\n", begin)
        found = self.code[begin : None if end < 0 else end].upper().find(sign)
        return begin + max(found, 0)

    def line(self, number: int) -> str:
        """Give a line as written; number: from 1."""
        begin = self._line_starts[number - 1]
        return self.text[begin : self._line_end(begin)]

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
        text = self.text[begin:end]
        if "\n" not in text:
            return text.strip()
        return re.sub(r"\s*\n\s*", " ", self.text[begin:end]).strip()

    def _blank(self) -> str:
        out = list(self.text)
        opened: list[int] = []
        offset = 0
        while True:
            match = (_SPECIAL if opened else _OUTSIDE).search(self.text, offset)
            if match is None and not opened:
                return "".join(out)
            if match is None:
                offset = self._give_up(out, opened)
                continue
            begin = match.start()
            try:
                end = self._element_end(begin, opened)
            except UserError as fault:
                self.faults.append(fault)
                first = opened[0] if opened else begin
                opened.clear()
                offset = self._line_end(begin)
                line_begin = self.text.rfind("\n", 0, first) + 1
                out[line_begin:offset] = _blanked(self.text[line_begin:offset])
                continue
            # Code stays; a line feed that ends a block stays as the mark between blocks.
            keeps = match.group() in '"[]' or end == begin
            if not keeps and match.group() != ")":
                out[begin:end] = _blanked(self.text[begin:end]) if end - begin > 1 else " "
            offset = max(end, begin + 1)

    def _give_up(self, out: list[str], opened: list[int]) -> int:
        """Blank the line of a bracket that nothing closes; what is after it is read as blocks."""
        line_begin = self.text.rfind("\n", 0, opened[0]) + 1
        line_end = self._line_end(opened[0])
        self.faults.append(self._not_closed(max(place for place in opened if place < line_end)))
        out[line_begin:] = _blanked(self.text[line_begin:line_end]) + self.text[line_end:]
        opened.clear()
        return line_end

    def _element_end(self, begin: int, opened: list[int]) -> int:
        """Give the end of the element that begins here; keep the list of open brackets."""
        sign = self.text[begin]
        if sign == '"':
            return self._string_end(begin)
        if sign == ";":
            return self._line_end(begin)
        if sign == "(":
            return self._comment_end(begin)
        if sign == "#":
            return self._long_comment_end(begin)
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

    def _long_comment_end(self, begin: int) -> int:
        """Give the end of #COMMENT BEGIN .. #COMMENT END. Source: programming manual."""
        if not _COMMENT_BEGIN.match(self.text, begin):
            if _COMMENT_END.match(self.text, begin):
                raise self.error("#COMMENT END without #COMMENT BEGIN", begin, value="#COMMENT END")
            return begin
        found = _COMMENT_END.search(self.text, begin)
        if found is None:
            # All that follows is comment then; there is nothing to read in it
            self.faults.append(
                self.error(
                    "comment is not closed", begin, value="#COMMENT BEGIN", allowed="#COMMENT END"
                )
            )
        return len(self.text) if found is None else found.end()

    def _continuation_end(self, begin: int) -> int:
        r"""`\` ends a line; the next one goes on and may carry a block number of its own.

        Source: programming manual, line break in a block.
        """
        match = _CONTINUATION.match(self.text, begin)
        if match is None:
            line_begin = self.text.rfind("\n", 0, begin) + 1
            if _CALL.match(self.text, line_begin, begin):
                return begin
            raise self.error(
                "the block goes on with a line break after this sign only",
                begin,
                value="\\",
                allowed="end of the line, with a further line after it",
            )
        return match.end()


def _blanked(text: str) -> str:
    """Give blanks of the same length."""
    return " " * len(text)
