"""What plans, rigs and this installation contain, as text."""
