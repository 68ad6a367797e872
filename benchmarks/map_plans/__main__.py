"""Run the benchmark: ``python -m benchmarks.map_plans``."""

import sys

from benchmarks.map_plans.benchmark import main

if __name__ == '__main__':
    sys.exit(main())
