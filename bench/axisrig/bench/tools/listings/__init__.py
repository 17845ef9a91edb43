"""What plans, rigs and this installation know, as text."""
