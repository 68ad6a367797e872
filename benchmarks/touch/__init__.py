"""Force and energy of the first touch."""
