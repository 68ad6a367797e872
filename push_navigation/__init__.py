"""The robot alone: paths round the object and through a map, and feedback along them."""
