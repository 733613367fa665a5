"""AP238 (ISO 10303-238): STEP-NC programs in the application interpreted model (AIM)."""
