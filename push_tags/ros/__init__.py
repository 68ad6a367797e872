"""Messages of cameras."""
