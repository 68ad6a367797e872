"""Simulate a task: the robot drives around the box and pushes it until it is at its goal."""

from pathlib import Path

from push_scenario import draw_figure, format_report, load_scenario, simulate

OUT = Path('out')


def main() -> None:
    """Print what the supervisor did and what the first plan expected, and draw the pushes."""
    result = simulate(load_scenario('task_two_pushes'))
    for change in result.history:
        print(f'{change.time:6.1f} s  {change.state.value:10}{change.reason}')
    first = result.sequence_plans[0]
    print(f'planned: {len(first.pushes)} pushes in {first.duration:.0f} s, or one push in '
          f'{first.single_push_time:.0f} s')
    print(format_report([result]))
    OUT.mkdir(exist_ok=True)
    draw_figure([result], OUT / 'task.png')


if __name__ == '__main__':
    main()
