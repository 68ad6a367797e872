"""Tags: object poses from images of AprilTags."""
