"""Distance control as far as it knows no axis: filters, controller, limits, states."""
