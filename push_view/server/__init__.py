"""The server of the page: commands in, messages out."""
