"""Find out what a base is like: what it is told, what came of it, and what that means."""
