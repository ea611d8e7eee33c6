"""Make the font of the tour's formulas: DejaVu Math TeX Gyre with the characters that they use.

Debian has it in the package `fonts-dejavu-extra`. Its license, that of Bitstream Vera, allows it to
be changed and passed on together with the license, which is in NOTICE.
"""

import sys
from pathlib import Path

from fontTools import subset

ROOT = Path(__file__).resolve().parents[1]
SOURCE = "/usr/share/fonts/truetype/dejavu/DejaVuMathTeXGyre.ttf"
TARGET = ROOT / "app" / "frontend" / "math.woff"
PLAIN = "".join(map(chr, range(0x20, 0x7F)))
GREEK = "αβγτπΩΣ" + "".join(map(chr, range(0x1D6FC, 0x1D71C)))
ITALIC = "".join(map(chr, range(0x1D434, 0x1D468))) + "\u210e"
SIGNS = "±×÷·−∑∫∈∉⊂⊆∪∩≤≥≠≈∝∞∥‖⇒→←∣|′″⏞⏟½⁄√⟨⟩…∖\u2061\u2062\u2063"


def main(source: str = SOURCE) -> None:
    """Write the font beside the page's scripts."""
    options = subset.Options(flavor="woff", layout_features=["*"], notdef_outline=True)
    font = subset.load_font(source, options)
    chosen = subset.Subsetter(options)
    chosen.populate(text=PLAIN + GREEK + ITALIC + SIGNS)
    chosen.subset(font)
    subset.save_font(font, str(TARGET), options)
    print(f"{TARGET.relative_to(ROOT)}: {TARGET.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main(*sys.argv[1:])
