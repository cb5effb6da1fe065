"""The robot: a PyBullet world, and the driver node that puts it on topics and services."""
