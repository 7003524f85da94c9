"""Independent proximal policy optimisation: every agent a learner of its own."""
