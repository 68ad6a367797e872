"""Studies of single straight pushes: what they do to an object, and which one is best when."""
