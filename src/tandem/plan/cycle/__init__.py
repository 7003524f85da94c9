"""The station repeats: cell in, front of cycle time and stress out."""
