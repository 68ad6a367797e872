"""Simulate one push with wrong friction, in open loop and under feedback: some seconds."""

from pathlib import Path

from push_scenario import draw_figure, format_report, load_scenario, simulate

OUT = Path('out')


def main() -> None:
    """Compare the two laws, as a table and as a figure."""
    scenario = load_scenario('corner_push_mismatch')
    results = [simulate(scenario, law) for law in ('open_loop', 'feedback')]
    print(format_report(results))
    OUT.mkdir(exist_ok=True)
    draw_figure(results, OUT / 'two_laws.png')


if __name__ == '__main__':
    main()
