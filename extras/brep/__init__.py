"""B-rep: solids of STEP files as triangles, by Open CASCADE."""
