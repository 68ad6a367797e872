"""Files of parameters: where those of the package are, and how they are read."""
