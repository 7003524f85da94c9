"""A station that repeats, for people: in the terminal, in files, on sheets, read back."""
