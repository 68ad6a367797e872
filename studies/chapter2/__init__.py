"""Chapter 2: the behaviour of a pushed object, and where pushing is stable."""
