"""The narrator: what the executor decided and why, rule by rule."""
