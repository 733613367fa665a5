"""STEP-NC programs: workingsteps, technologies, tools and what is doubtful."""
