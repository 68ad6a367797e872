"""
Tolerances: what a good robot, its odometry and its tracker may do without being stopped.

Everything that decides whether the robot stops, or goes on again, is in this table; a greater
value stops it later. Values are chosen unless a comment says how they were measured: so that none
of the faults of ``benchmarks/faults`` goes unnoticed, and that hours of simulated drives of good
robots, with other lags, delays, wheels and noise than stated, have no stop.
"""

# Stamps, compared with the time of odometry.

# Messages in a row that have to agree with each other to be believed, where one alone is not: of
# another time, or of an object elsewhere. No two accidents agree, and no three.
AGREEING_MESSAGES = 3
# Difference between a stamp and the time of odometry [s]: longer than any latency.
MAX_STAMP_OFFSET = 1.0
# Time for which odometry goes on at another time until time itself has changed [s]: clocks that
# are set right again are so within two or three seconds.
NEW_CLOCK_TIME = 3.0
# Time by which odometry may fall back [s]: two periods at 50 Hz, by which stamps of messages that
# are made in a hurry come out of order.
MAX_CLOCK_SHIFT = 0.04

# Object poses, compared with those before them.

# What an object may move from one pose to the next: constant part [m], [rad], and by time [m/s],
# [rad/s]. Far more than robots push it, and noise of 2 cm besides.
OBJECT_JUMP_DISTANCE = 0.15
OBJECT_JUMP_ROTATION = 0.5
MAX_OBJECT_SPEED = 1.0
MAX_OBJECT_YAW_RATE = 3.0
# Time without any pose after which the next one is believed wherever it is [s]: somebody may have
# moved the object meanwhile.
MAX_POSE_GAP = 1.0
# Times that a pose may come again from a tracker with noise: a message may be sent twice.
MAX_POSE_REPETITIONS = 3
# What a heading that the tracker mistakes may differ from one in which the object looks the same
# [rad], and how far the object may move meanwhile [m]: the noise of a tracker, and what an object
# is pushed between two of its poses.
HEADING_JUMP_ROTATION = 0.15
HEADING_JUMP_DISTANCE = 0.05

# Odometry, compared with itself: its pose with its twist.

# What a step of the pose may differ from its twist: constant part [m], [rad], and over what the
# twist means. The rounding of bases, and one step of acceleration.
ODOMETRY_JUMP_DISTANCE = 0.03
ODOMETRY_JUMP_ROTATION = 0.08
ODOMETRY_JUMP_RATIO = 1.0
# The constant part where the pose is absolute [m], [rad]: a correction of a map's localization.
ABSOLUTE_JUMP_DISTANCE = 0.15
ABSOLUTE_JUMP_ROTATION = 0.2
# The same over the standard deviations that the pose states: two independent errors, four
# standard deviations of their difference.
ABSOLUTE_JUMP_SIGMAS = 6.0
# The same at most, whatever is stated [m], [rad]: a robot that may be anywhere has to stop.
MAX_CORRECTION_DISTANCE = 1.0
MAX_CORRECTION_ROTATION = 0.5
# Least step of an absolute pose that is such a correction [m], [rad], and the time in which only
# one of them is excused [s]: a twist that is wrong shows at every step.
MIN_CORRECTION_DISTANCE = 0.01
MIN_CORRECTION_ROTATION = 0.02
CORRECTION_PERIOD = 1.0
# A step longer than this may begin and end at any velocity [s]: some lost messages.
MAX_ODOMETRY_STEP = 0.25
# What odometry that had stood still may have moved over what was commanded meanwhile: the robot
# follows with a lag.
CATCH_UP_RATIO = 1.5
# Sliding window [s], and what the sum of the steps may differ from the sum of the twists in it:
# constant part [m], [rad], and over the greater of the two. 0.3 m/s are noticed in 0.2 s.
WINDOW_TIME = 0.6
WINDOW_DISTANCE = 0.03
WINDOW_ROTATION = 0.1
WINDOW_RATIO = 0.4
# Path over which the direction of the steps is compared with that of the twist [m], and what the
# two may differ by: constant part [m], and over the path, along it and to its side. Wheels that
# are not quite of the stated size, and 6 deg between the axes.
DIRECTION_PATH = 0.3
DIRECTION_DISTANCE = 0.03
DIRECTION_RATIO = 0.2
LATERAL_RATIO = 0.1
# The same where the robot does not move as commanded, which may be a mistake of odometry: constant
# part [m], and by the path [m] the part of it; what shows before the motion is a fault.
EARLY_DISTANCE = 0.003
EARLY_RATIOS = {0.01: 0.4, 0.02: 0.14, 0.05: 0.12}
# Velocity to the side of a differential drive that does not move as commanded at which the twist
# is in wrong axes [m/s], and over the yaw rate [m]: noise, wheels that slip in a turn, and a frame
# of the robot that lies before or behind its axle.
LATERAL_SPEED = 0.05
LATERAL_LEVER = 0.3
# Time for which a pose may come again from a robot that moves [s], what it may have moved by its
# twist meanwhile, over the last step of the pose, and the greatest step that counts [m], [rad].
# Messages may be more frequent than what they are made of; half a diagonal more than poses that
# are rounded need, and the coarsest rounding that is common.
REPETITION_TIME = 0.15
REPETITION_RATIO = 2.0
MAX_ROUNDING = 0.01, 0.02

# Motion, compared with commands.

# Lever by which a rotation counts as a distance [m]: a radius of the robots.
LEVER_ARM = 0.2
# Delay with which a base may begin to follow, odometry included [s]: bases that are driven over a
# network have 0.05 to 0.2 s.
MAX_RESPONSE_TIME = 0.3
# How it may follow then: ratio and margin [s] of its lag over the nominal one, and acceleration
# over its limit; the middle ones are as stated. Loaded bases are slower, empty ones quicker; in
# steps by which a change of the speed by 0.3 m/s takes a fifth more or less of its time.
LAGS = ((0.3, 0.0), (1.0, 0.0), (2.0, 0.05))
ACCELERATION_RATIOS = (0.5, 0.7, 1.0, 1.4, 2.0)
# Residual velocity: constant part [m/s], over the velocity along the same axis, over that of the
# wheels, and over the acceleration [s]. The noise of odometry, wheels that are not quite of the
# stated size or not of the same, and delays between those of the models.
SPEED_TOLERANCE = 0.012
AXIS_TOLERANCE = 0.08
WHEEL_TOLERANCE = 0.03
TIME_TOLERANCE = 0.035
# The same of a base that is known to follow closely: constant part [m/s], and over the parts by
# velocity above. Noise of odometry, and half of the error of wheels.
CLOSE_SPEED_TOLERANCE = 0.009
CLOSE_RATIO = 0.5
# How long each axis has to have moved within that until the base is known to [s]: two seconds show
# acceleration and speed.
LEARNING_TIME = 2.0
# Error of the velocity of a base at which its command has jumped [m/s], and how long that shows
# [s]. Above what a command that changes at the limit of the acceleration leaves behind a lag of
# 0.1 s, and longer than a base with another acceleration takes for a jump of 0.6 m/s.
COMMAND_JUMP = 0.15
SETTLING_TIME = 0.4
# Sum of the residuals over their tolerances, less one, at which a model does not explain the
# motion [s]: a base that fails is stopped within 0.3 s.
MAX_RESIDUAL_SUM = 0.3
# How much worse than a constant velocity the models may explain the motion [m^2/s], and how much
# later the base may follow than they do [s]: variations of commands by 4.5 mm/s for half a second,
# and nearly half of the step of their delays. Bases that ignore changes of their commands by up to
# 15 mm/s do not reach it in simulated drives.
STUCK_EXCESS = 1e-5
STUCK_LATENESS = 0.02
# Delay that is a fault [s]: above the longest delay of the models and a lag, and between two steps
# of the search.
MIN_LATENESS = 0.425
# Part of the variance, and of what is left of it without a delay, that a delay may leave to be the
# reason, and what it leaves at least [m/s]: the steps of a base that ignores changes of its
# commands by 15 mm/s are not taken for a delay.
LATE_VARIANCE_RATIO = 0.3
MIN_LATE_ERROR = 0.0045
# Gap in odometry after which it is not known what the base has been doing [s].
MAX_MOTION_GAP = 0.5

# The stop, and what ends it.

# Velocity below which a robot is at rest [m/s], [rad/s]: above the noise of odometry.
REST_SPEED = 0.02
REST_YAW_RATE = 0.1
# Time for which it rests before it may go on [s]: longer than a drive takes to react.
REST_TIME = 0.5
# The same where it was stopped again so soon after it went on [s]: beyond the drop-outs and
# restarts of most parts, so that one of them is not counted as many.
RELAPSE_TIME = 5.0
RELAPSE_REST_TIME = 5.0
# Time for which it has to move as commanded until its base is known to follow again [s]: longer
# than it takes to notice a base that moves otherwise.
FOLLOWING_TIME = 1.0
# Part of the greatest standstill after which the last attempt to move is made: a robot has sped up
# by then, and with the default limit a base that was away for two seconds is back.
LAST_ATTEMPT_RATIO = 2.0 / 3.0
# Time without odometry after which a robot slows down, at least [s], and over the longest time
# between two recent messages; and in which it then comes to rest [s]: three messages at 50 Hz, and
# before the time-out of odometry.
MAX_SILENCE = 0.06
SILENCE_RATIO = 1.5
SLOWING_TIME = 0.15
