"""From staged pages to a site that asks nothing of any other server."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

# The theme would advertise its successor in the middle of what MkDocs says.
os.environ["NO_MKDOCS_2_WARNING"] = "1"

from mkdocs.commands.build import build
from mkdocs.config import load_config
from mkdocs.exceptions import Abort

from docs.site.pages import stage_pages

SETTINGS = Path(__file__).with_name("mkdocs.yml")


class SiteError(Exception):
    """A page warns: of a link that leads nowhere, of a formula that cannot be read."""


def build_site(output: Path, runs: Path, examples: tuple[str, ...] | None = None) -> None:
    """Build the site into a folder, with every warning an error.

    Args:
        output: what it held before is gone.
        runs: folder with result file and picture of each example of the gallery.
        examples: names of those examples; by default all.

    Raises:
        SiteError: a page warns.
    """
    with tempfile.TemporaryDirectory() as folder:
        pages = Path(folder)
        contents = stage_pages(pages, runs, examples)
        config = load_config(
            str(SETTINGS),
            docs_dir=str(pages),
            site_dir=str(output.resolve()),
            nav=contents,
            strict=True,
        )
        config.plugins.on_startup(command="build", dirty=False)
        try:
            build(config)
        except Abort as abort:
            raise SiteError(str(abort)) from abort
        finally:
            config.plugins.on_shutdown()
