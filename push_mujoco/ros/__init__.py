"""The simulator in MuJoCo as a node: what it publishes besides."""
