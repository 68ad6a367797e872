"""Plan one push of a box to a goal pose, verify the plan and save it: a few milliseconds."""

import math
from pathlib import Path

from push_model import Pose
from push_planner import plan_push, problem_from_placement, verify
from push_scenario import read_object, read_robot

OUT = Path('out')


def main() -> None:
    """Push the box from its face, one and a half metres ahead and to the left."""
    box = read_object('box_04')
    robot = read_robot('holonomic_017')
    problem = problem_from_placement(box, robot, object_pose=Pose(0.0, 0.0, 0.0),
                                     robot_pose=Pose(-0.37, 0.0, 0.0), goal=Pose(1.5, 0.4, 0.5))
    plan = plan_push(problem)
    check = verify(plan)  # an independent integration of the equation of motion, by scipy
    print(f'push of {plan.trajectory.path_length:.2f} m in {plan.trajectory.duration:.1f} s')
    print(f'misses the goal by {1e3 * check.position_error:.3f} mm and '
          f'{math.degrees(check.heading_error):.4f} deg, uses '
          f'{100 * check.friction_usage:.0f} % of the friction cone')
    OUT.mkdir(exist_ok=True)
    plan.save(OUT / 'push.npz')


if __name__ == '__main__':
    main()
