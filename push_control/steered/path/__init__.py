"""Path of the flat output point and the guidance along it."""
