"""Solids of STEP files: B-rep that Open CASCADE turns into triangles."""
