"""What users name and type: kinds of files, parts, numbers."""
