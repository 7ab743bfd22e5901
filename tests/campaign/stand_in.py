"""A campaign that does nothing, for the tests of campaigns."""

from __future__ import annotations

import argparse
import sys

if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("count", type=int)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--fails", action="store_true")
    sys.exit("this one is wrong" if parser.parse_args().fails else 0)
