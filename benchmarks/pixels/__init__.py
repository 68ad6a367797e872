"""Tasks in MuJoCo whose object is known by images alone."""
