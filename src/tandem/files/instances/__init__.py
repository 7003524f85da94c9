"""Benchmark instances by name: those that ship with Tandem, and those in a folder of one's own."""
