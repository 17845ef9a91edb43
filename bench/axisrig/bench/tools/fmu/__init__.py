"""What a user asks about an FMU before trusting it: what it is, and what it keeps."""
