"""Measure and write the report: ``python -m benchmarks.speed``."""

import sys

from benchmarks.speed.report import main

if __name__ == '__main__':
    sys.exit(main())
