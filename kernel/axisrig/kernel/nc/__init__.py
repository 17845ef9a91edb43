"""The NC language: program text in, canonical commands for the channel out.

`text.parser.parse_program` checks a whole program, `decoder.Interpreter` runs it and yields the
commands of `canon`. Words, commands and variables are tables (`text/*.csv`).
"""
