"""The parts that screens with runs are put together from, each with a state and actions of its own."""
