"""What every topic of the judge shares: a recording with what is looked up in it, values, marks."""
