"""Running: one program, one case, a campaign; what was observed; how fast it was."""
