"""Writes files atomically, and reads untrusted files, TOML and YAML within limits."""
