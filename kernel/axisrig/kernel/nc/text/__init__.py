"""NC text to checked statements: blanks and blocks (`source`), grammar, tables of words."""
