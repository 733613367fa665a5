"""API keys of the service: create, list, revoke."""
