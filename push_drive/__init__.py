"""The robot alone: ways round the object and through a map, and how to follow them."""
