"""The topics of the language that need no other: motion, measuring, tools, drives, messages."""
