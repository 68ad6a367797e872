"""Maps round the perimeter of an object: stable pushing and steering."""
