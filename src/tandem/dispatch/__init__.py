"""Who decides live what happens next, and how the deciders are judged."""
