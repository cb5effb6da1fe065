"""Quality of service: policies, profiles and their compatibility."""
