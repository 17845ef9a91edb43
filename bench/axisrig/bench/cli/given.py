"""The options that a call of the command line was given, as words."""

from dataclasses import dataclass

import typer

from axisrig.bench.cli.options import jobs_text


@dataclass(frozen=True)
class Given:
    """options: names that take the place of stored ones; words: all of the call; valued: names of
    the options of the command that a value follows.
    """

    options: frozenset[str]
    words: list[str]
    valued: frozenset[str]


def given_options(context: typer.Context) -> Given:
    """Return the options of this call; those that may come several times add to stored ones."""
    given, words, valued = set[str](), list[str](), set[str]()
    for option in context.command.params:
        name, is_flag = option.name or "", bool(getattr(option, "is_flag", False))
        if not is_flag:
            valued |= {*option.opts}
        source = context.get_parameter_source(name)
        if source is None or source.name != "COMMANDLINE":
            continue
        value, first = context.params[name], option.opts[0]
        if getattr(option, "multiple", False):
            words += [word for one in value for word in (first, str(one))]
            continue
        given |= {*option.opts}
        text = jobs_text(value) if name == "jobs" else str(value)
        words += [first] if is_flag else [first, text]
    return Given(frozenset(given), words, frozenset(valued))
