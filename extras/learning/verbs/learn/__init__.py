"""Learn a model from a data set, and measure it beside simple baselines.

The first rows train the model, the next ones test it. With --on-physics, --outcome writes the
factor on k_c for `stepnc kbe add`; --program names the part whose tool it belongs to.
"""
