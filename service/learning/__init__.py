"""Models learned from data sets by scikit-learn, measured beside simple baselines."""
