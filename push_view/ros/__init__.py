"""The page beside a robot: its commands as topics and services."""
