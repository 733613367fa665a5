"""Long work in processes of its own: claimed, watched, cancelled, told about."""
