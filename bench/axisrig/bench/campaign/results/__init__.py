"""The results folder: written, read back, as JUnit."""
