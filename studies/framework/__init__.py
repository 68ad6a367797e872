"""Framework of the studies: parameters, runs, output files, plot style and drawing primitives."""
