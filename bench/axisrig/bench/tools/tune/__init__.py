"""Helpers for the user who tunes a control: they measure a loop and say what follows."""
