"""Maps round the perimeter of an object: where pushing is stable, and what can be steered."""
