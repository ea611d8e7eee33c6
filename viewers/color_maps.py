"""Control points of the colour maps, mixed in OKLab, so that equal steps look equal."""

STOPS: dict[str, tuple[tuple[int, int, int], ...]] = {
    # from the body's own grey to glowing orange: what a bone does not hold stays quiet
    "weight": (
        (201, 206, 214),
        (236, 197, 142),
        (247, 160, 72),
        (240, 105, 32),
        (192, 46, 30),
        (128, 14, 38),
    ),
    # from the body's own grey to dark violet: where nothing is wrong nothing is said
    "error": (
        (201, 206, 214),
        (247, 217, 126),
        (246, 148, 66),
        (218, 66, 78),
        (142, 26, 108),
        (64, 12, 78),
    ),
    # less is blue, more is red, the same is the body's own grey
    "difference": (
        (24, 78, 158),
        (92, 158, 206),
        (201, 206, 214),
        (238, 136, 96),
        (172, 22, 44),
    ),
    # near is light and warm, far is deep blue
    "distance": (
        (255, 245, 214),
        (250, 205, 128),
        (143, 198, 140),
        (45, 158, 158),
        (38, 104, 160),
        (52, 54, 128),
        (38, 22, 72),
    ),
    # few influences are calm, many glow
    "count": ((214, 224, 236), (150, 190, 214), (86, 148, 178), (132, 92, 160), (96, 34, 92)),
    # from the surface's green to the deepest orange
    "depth": ((176, 214, 108), (235, 200, 90), (255, 140, 40), (214, 66, 14), (120, 24, 20)),
    # winding numbers: outside is grey, inside orange
    "winding": ((150, 158, 172), (176, 172, 168), (226, 158, 110), (255, 108, 12)),
    # the same on the face of a cut, on which orange edges are to be seen
    "inside": ((176, 182, 194), (214, 206, 226), (152, 126, 190), (92, 62, 140)),
}
