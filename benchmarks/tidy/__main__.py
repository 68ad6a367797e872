"""Run the benchmark: ``python -m benchmarks.tidy``."""

import sys

from benchmarks.tidy.benchmark import main

if __name__ == '__main__':
    sys.exit(main())
