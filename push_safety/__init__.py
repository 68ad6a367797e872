"""
Safety: four checks of what is measured and commanded, and the guard that stops the robot.

The checks compare stamps of messages with the present time (``stamp_check``), object poses with
those before them (``pose_check``), the pose of odometry with its twist (``odometry_check``), and
the velocity of the robot with its commands (``motion_check``), by models of a base that follows
(``drive_models``) and a search for one that is late (``delay_search``).

``layer`` is the guard, ``stop`` says when a stopped robot may go on, ``tolerances`` is the table
of all that is tolerated, and ``status`` names the reasons.
"""
