"""Framework of the studies: parameters, runs, files, plot style and sketches."""
