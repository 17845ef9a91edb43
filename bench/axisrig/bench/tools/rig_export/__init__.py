"""A rig as a System Structure and Parameterization package, for other co-simulation masters."""
