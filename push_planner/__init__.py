"""Plans for pushing an object to a goal pose."""
