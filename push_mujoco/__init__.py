"""A robot with wheels, bumper, lidar and camera in MuJoCo, and images of what it sees."""
