"""
Names of the numbers that the kernel works on.

State: mass centre, its velocity and its acceleration over the last step (world; 0 where it tells
nothing of the next step), robot pose (world) and twist (own axes), contact mode, contact force
over the last step [N], energies since the start [J], iterations, steps and steps whose
equations were left unsolved since the start.
"""

(X, Y, THETA, V_X, V_Y, OMEGA, A_X, A_Y, A_OMEGA, P_X, P_Y, PHI, U_X, U_Y, U_OMEGA,
 MODE, FORCE_N, FORCE_T, WORK, SUPPORT_LOSS, CONTACT_LOSS, IMPACT_LOSS, ITERATIONS,
 STEPS, UNSOLVED) = range(25)
STATE_SIZE = UNSOLVED + 1
(MASS, INERTIA, COM_X, COM_Y, DISC_RADIUS, ROBOT_RADIUS, CONTACT_FRICTION, SMOOTHING) = range(8)
SEPARATE, STICK, SLIDE_LEFT, SLIDE_RIGHT = range(4)
ANY = -1
MODES = ('separate', 'stick', 'slide+', 'slide-')
