"""Build the site: ``python -m docs.site``, or ``make docs``."""

from __future__ import annotations

import argparse
from pathlib import Path

from docs.site.build import build_site
from docs.site.gallery import draw_examples

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--output", type=Path, default=Path("build/site"), help="folder for the site")
parser.add_argument("--runs", type=Path, default=Path("out"), help="folder of the runs of examples/demo.py")
arguments = parser.parse_args()
draw_examples(arguments.runs)
build_site(arguments.output, arguments.runs)
print(f"The site begins at {(arguments.output / 'index.html').resolve()}.")
