"""The makers of the characters in ../shared/data, of which one at a time is left out."""

from __future__ import annotations

MAKERS = {
    "adv_": "Kay Lousberg",
    "babylon": "Babylon.js",
    "boxman": "J. Blaha",
    "emoji": "Microsoft",
    "godot_hand": "Godot XR",
    "godot_mannequiny": "GDQuest",
    "godot": "Godot",
    "godotxr": "Godot XR Tools",
    "greenman": "@iP",
    "hackmit": "HackMIT",
    "kaykit": "Kay Lousberg",
    "khronos": "Khronos",
    "m2m": "Mesh2Motion",
    "makehuman": "MakeHuman",
    "packt": "Packt",
    "pmndrs_low_poly_horse": "unknown (horse)",
    "pmndrs_skater": "Kenney",
    "polyme": "W. Yip",
    "webxr": "Amazon",
}
"""By the beginnings of names; the longest that fits counts."""
VALID = ("AIAN", "Asian", "Black", "Hispanic", "MENA", "White", "X_", "valid")


def maker_of(name: str) -> str:
    """Return the maker of a character; most of those of the train set are by Quaternius."""
    if name.startswith(VALID):
        return "VALID"
    fitting = [start for start in MAKERS if name.startswith(start)]
    return MAKERS[max(fitting, key=len)] if fitting else "Quaternius"
