"""The knowledge base: outcomes of runs, their evaluation, corrections.

examples:
  stepnc kbe list --machine vmc15 --since 2026-03-01
  stepnc kbe table --only violated -o table.html
  stepnc kbe review
  stepnc kbe accept 3 --by "A. Smith"
  stepnc kbe export outcomes --format parquet -o outcomes.parquet

The knowledge base holds outcomes of runs and corrections for plans. It is named by --kb, else
by $STEPNC_KB, else it is ~/.local/share/stepnc/knowledge.db.
"""
