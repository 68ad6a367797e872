"""Run the benchmark: ``python -m benchmarks.tasks``."""

import sys

from benchmarks.tasks.benchmark import main

if __name__ == '__main__':
    sys.exit(main())
