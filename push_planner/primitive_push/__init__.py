"""Plans of straight, unsteered pushes and taps at faces, from a table of primitives."""
