"""Perception: where robot and object are, and whether measurements can be used."""
