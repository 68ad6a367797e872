"""Command line ``push cache``: what the cache of machine code and tables holds; clear it."""

import argparse
from collections.abc import Sequence
import sys

from push_dynamics.user_cache import cache_path, cached_files, clear_cache, MAX_SIZE

DONE = 0
MEGABYTE = 1e6
TABLE_SUFFIX = '.npz'


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run the command line.

    :param arguments: words after the command's name; None for those of the process.
    :return: exit status.
    """
    options = make_parser().parse_args(arguments)
    files = cached_files()
    tables = [file.size for file in files if file.path.suffix == TABLE_SUFFIX]
    code = [file.size for file in files if file.path.suffix != TABLE_SUFFIX]
    print(cache_path())
    for title, sizes in (('machine code', code), ('tables of pushes', tables)):
        print(f'{title.ljust(16)}  {len(sizes):5d} files  {sum(sizes) / MEGABYTE:7.1f} MB')
    print(f'at most {MAX_SIZE / MEGABYTE:.0f} MB are kept, those that were used last')
    if options.clear:
        clear_cache()
        print('cleared')
    return DONE


def make_parser() -> argparse.ArgumentParser:
    """Make the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog='push cache', description='Show what the cache of compiled code and of tables of '
        'pushes holds. What is not there is made again when it is needed.')
    parser.add_argument('--clear', action='store_true', help='remove all of it')
    return parser


if __name__ == '__main__':
    sys.exit(main())
