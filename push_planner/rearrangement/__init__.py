"""Order in which several objects are brought to their goals, one after the other."""
