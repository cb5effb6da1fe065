"""How a program failed, in the words a learner can act on."""
