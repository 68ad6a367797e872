"""A room in order: several objects, one after the other, in one process."""
