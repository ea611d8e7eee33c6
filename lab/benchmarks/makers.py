"""The makers of the characters in ../shared/data."""

from __future__ import annotations

MAKERS = {
    "adan_": "Adan",
    "adv_": "Kay Lousberg",
    "babylon": "Babylon.js",
    "barav_": "BaraV",
    "boxman": "J. Blaha",
    "bubba": "Hasksoft",
    "dcl_": "Decentraland",
    "duck_": "Friendl-e-Duck",
    "emoji": "Microsoft",
    "flock_": "Flip Computing",
    "godette": "SirRichard94",
    "godot": "Godot",
    "godot_hand": "Godot XR",
    "godot_mannequiny": "GDQuest",
    "godotxr": "Godot XR Tools",
    "goon_": "MrGoonAndWatch",
    "greenman": "@iP",
    "hackmit": "HackMIT",
    "kaykit": "Kay Lousberg",
    "khronos": "Khronos",
    "leap_": "Leap Motion",
    "m2m": "Mesh2Motion",
    "makehuman": "MakeHuman",
    "mannyquin": "Cat Prisbrey",
    "minnyquinn": "Cat Prisbrey",
    "neither_": "NeitherDucks",
    "nofil_": "Nofil.Khan",
    "norah_": "N. van Nimwegen",
    "overaction_": "Overaction Game Studio",
    "ozz_": "ProAnimationBank",
    "pablo_": "Pablo444",
    "packt": "Packt",
    "phoenix": "NORBERTO-3D",
    "pmndrs_low_poly_horse": "unknown (horse)",
    "pmndrs_skater": "Kenney",
    "polyme": "W. Yip",
    "pumpkin_": "outcast945",
    "ramirez_": "M. Ramirez",
    "red_panda": "galiulinEldar",
    "space_survivor": "s.probka",
    "stakler_": "Stakler",
    "sumerian_": "Amazon",
    "tnua_": "I. Arye",
    "ulysses_": "eb78",
    "uxr_": "VRMADA",
    "valve_": "Valve",
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
