"""`[language]` of a rig: published words of programs that it passes over."""

from pathlib import Path

from axisrig.bench.rig.reading.file import RigFile, rig_error
from axisrig.kernel.errors import nearest
from axisrig.kernel.nc.text.published import published
from axisrig.kernel.nc.text.words import commands, words


def language_notes(rig: RigFile, files: list[Path]) -> list[str]:
    """Say which words are passed over and why.

    Raises UserError for one that no table has, and for one that would act on the machine.
    """
    may = [word for word, row in published().items() if row.passed_over]
    notes = []
    for word in rig.language.pass_over:
        row = published().get(word)
        if row is None or not row.passed_over:
            is_known = row is not None or word in words("G") or word[1:] in commands()
            message = (
                f"{word} may not be passed over: it acts, or would act on the machine"
                if is_known
                else "no published word that could be passed over"
            )
            raise rig_error(
                files,
                ("language", "pass_over"),
                message,
                value=word,
                allowed=([] if is_known else nearest(word, may)) or may,
            )
        notes.append(f"{word} of a program is passed over: {row.passed_over}")
    return notes
