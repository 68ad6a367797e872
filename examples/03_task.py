"""Simulate a task: the robot drives around the box and pushes it until it is at its goal."""

from pathlib import Path

from push_scenario import draw_figure, format_report, load_scenario, simulate

OUT = Path('out')


def main() -> None:
    """Print what the supervisor did and what the first plan expected, and draw the pushes."""
    result = simulate(load_scenario('task_approach'))
    for change in result.history:
        print(f'{change.time:6.1f} s  {change.state.value:10}{change.reason}')
    first = result.task_plans[0]
    print(f'first plan: a {first.trajectory.style.value} push of {first.length:.2f} m, the task '
          f'is expected to take {first.expected_time:.0f} s')
    print(format_report([result]))
    OUT.mkdir(exist_ok=True)
    draw_figure([result], OUT / 'task.png')


if __name__ == '__main__':
    main()
