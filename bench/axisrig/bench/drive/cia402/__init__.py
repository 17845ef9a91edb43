"""A drive of CiA 402: its objects, states, modes of operation, touch probe. No bus here."""
