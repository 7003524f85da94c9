"""Published systems, run here: what each is, and published against ours against exact."""
