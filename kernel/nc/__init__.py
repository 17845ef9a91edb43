"""The NC language: program text in, canonical commands for the channel out.

`parser.parse_program` checks a whole program, `interpreter.Interpreter` runs it and yields the
commands of `canon`. Words and variables are tables (`words.csv`, `variables.csv`).
"""
