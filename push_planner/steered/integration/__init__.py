"""Fine integration of a planned push, its refinement and its trajectory."""
