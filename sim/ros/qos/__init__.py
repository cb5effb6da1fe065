"""Quality of service: policies, profiles, and which offer meets which request."""
