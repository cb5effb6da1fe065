"""How a program failed, in words that a learner can act on."""
