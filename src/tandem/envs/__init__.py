"""Standard faces of Tandem's worlds: PettingZoo and Gymnasium."""
