"""A hook of MkDocs: formulas become MathML while the site is built, which browsers draw without a script.

The font that they are drawn in comes with the site: few machines have one with all of their letters.
"""

from __future__ import annotations

import html
import logging
import re
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

from fontTools import subset
from latex2mathml.converter import convert

INLINE = re.compile(r'<span class="arithmatex">\\\((.*?)\\\)</span>', flags=re.DOTALL)
BLOCK = re.compile(r'<div class="arithmatex">\s*\\\[(.*?)\\\]\s*</div>', flags=re.DOTALL)

LETTER = re.compile(r"&#x(?!000[0-7])[0-9A-F]+;")
"""A letter beyond ASCII, which the converter writes as a number."""

UPRIGHT = re.compile(r"<mi>(?=[Α-Ω]</mi>)")
"""Capitals of Greek, which TeX sets upright and MathML italic."""

TIGHT = re.compile(r"<mo>(?=&#x0002F;</mo>)")
"""A stroke of division, which MathML sets apart."""

BAR = re.compile(r"<mo[^>]*>(\||&#x0007C;|‖|∥)</mo>")
"""A bar of a norm, which MathML takes for a relation."""

HAT = re.compile(r"<mo>&#x0005E;</mo>")
"""The sign of a power, which the converter takes for a hat."""

WORD = re.compile(r"<m([io])>([A-Za-z]{2,})</m\1>")
"""The name of a function, such as tanh."""

FONT = "ziamath/fonts/STIXTwoMath-Regular.ttf"
"""STIX Two Math, under the SIL Open Font License, as the package ziamath has it."""

log = logging.getLogger("mkdocs.formulas")

letters: set[str] = set()
"""Of all formulas of the site."""


def on_page_content(content: str, page: Any, **_: Any) -> str:
    """Replace the formulas of a page; one that cannot be read is a warning."""
    where = page.file.src_uri
    inline = INLINE.sub(lambda match: mathml(match[1], "inline", where), content)
    return BLOCK.sub(lambda match: f'<div class="formula">{mathml(match[1], "block", where)}</div>', inline)


def on_post_build(config: Any, **_: Any) -> None:
    """Write the font with the letters of the formulas alone."""
    options = subset.Options(flavor="woff", layout_features=["*"], notdef_outline=True, name_IDs=["*"])
    subsetter = subset.Subsetter(options)
    subsetter.populate(text="".join(sorted(letters | _styled(letters))))
    with subset.load_font(str(distribution("ziamath").locate_file(FONT)), options) as font:
        subsetter.subset(font)
        subset.save_font(font, str(Path(config.site_dir) / "assets" / "formulas.woff"), options)


def mathml(source: str, display: str, where: str) -> str:
    """A formula as MathML.

    Args:
        source: TeX, as it stands in HTML.
        display: ``inline`` or ``block``.
        where: the page, for a warning.
    """
    formula = convert(html.unescape(source), display=display)
    # What the converter does not know it writes as it is.
    if "\\" in formula:
        log.warning("%s: the formula %s cannot be read", where, source)
    formula = LETTER.sub(lambda match: html.unescape(match[0]), formula)
    formula = UPRIGHT.sub('<mi mathvariant="normal">', formula)
    formula = TIGHT.sub('<mo lspace="0" rspace="0">', formula)
    formula = HAT.sub('<mo stretchy="false">\u02c6</mo>', formula)
    formula = WORD.sub(r'<mo form="prefix" lspace="0.17em" rspace="0">\2</mo>', formula)
    formula = BAR.sub(r'<mo stretchy="false" lspace="0.1em" rspace="0.1em">\1</mo>', formula)
    letters.update(html.unescape(re.sub(r"<[^>]*>", "", formula)))
    return formula


def _styled(plain: set[str]) -> set[str]:
    """The italic letters that browsers draw for single ones: those of the block of mathematical alphabets."""
    latin = {chr(0x1D434 + ord(letter) - ord("A")) for letter in plain if "A" <= letter <= "Z"}
    latin |= {chr(0x1D44E + ord(letter) - ord("a")) for letter in plain if "a" <= letter <= "z"}
    greek = {chr(0x1D6FC + ord(letter) - ord("α")) for letter in plain if "α" <= letter <= "ω"}
    # These have places of their own: h, and the variants of epsilon, theta, kappa, phi, rho and pi; ∂.
    # A root is no letter of its formula.
    return latin | greek | set("ℎ𝜕𝜖𝜗𝜘𝜙𝜚𝜛√")
