"""The NC language: program text in, canonical commands for the channel out.

`parser.parse_program` checks a whole program, `decoder.Interpreter` decodes it and yields the
commands of `canon`. Words and variables are tables (`words.csv`, `variables.csv`).
"""
