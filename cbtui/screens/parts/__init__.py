"""The parts that screens with runs are composed of, each with its own state and actions."""
