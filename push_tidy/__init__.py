"""Several objects: which is moved next, what became of each, and where the others stand."""
