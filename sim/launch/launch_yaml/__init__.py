"""``launch_yaml``: launch files in YAML."""
