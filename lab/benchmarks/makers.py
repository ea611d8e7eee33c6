"""The makers of the characters in ../shared/data."""

from __future__ import annotations

MAKERS = {
    "abbott_": "danielabbott",
    "adan_": "Adan",
    "adv_": "Kay Lousberg",
    "almaral_": "Denys Almaral",
    "babylon": "Babylon.js",
    "bamba_": "Bamba_Negra",
    "barav_": "BaraV",
    "boxman": "J. Blaha",
    "bubba": "Hasksoft",
    "creator_": "creator830",
    "darby_": "Elyse Darby",
    "dcl_": "Decentraland",
    "deok_": "Quaternius",
    "djmaesen_": "DJMaesen",
    "duck_": "Friendl-e-Duck",
    "duznot_": "Duznot",
    "elefante_": "planeta-elefante",
    "emoji": "Microsoft",
    "flock_": "Flip Computing",
    "gentry_": "Christian Gentry",
    "godette": "SirRichard94",
    "godot": "Godot",
    "godot_hand": "Godot XR",
    "godot_mannequiny": "GDQuest",
    "godotxr": "Godot XR Tools",
    "goon_": "MrGoonAndWatch",
    "greenman": "@iP",
    "hackmit": "HackMIT",
    "hiukim_": "hiukim",
    "jungle_": "Jungle Jim",
    "kaykit": "Kay Lousberg",
    "khronos": "Khronos",
    "leap_": "Leap Motion",
    "m2m": "Mesh2Motion",
    "makehuman": "MakeHuman",
    "mannyquin": "Cat Prisbrey",
    "minnyquinn": "Cat Prisbrey",
    "mujib_": "Mujib",
    "neither_": "NeitherDucks",
    "nofil_": "Nofil.Khan",
    "norah_": "N. van Nimwegen",
    "overaction_": "Overaction Game Studio",
    "ozz_": "ProAnimationBank",
    "pablo_": "Pablo444",
    "packt": "Packt",
    "phoenix": "NORBERTO-3D",
    "picasty_": "Picasty",
    "pmndrs_low_poly_horse": "unknown (horse)",
    "pmndrs_skater": "Kenney",
    "polyme": "W. Yip",
    "pumpkin_": "outcast945",
    "quat": "Quaternius",
    "ramirez_": "M. Ramirez",
    "red_panda": "galiulinEldar",
    "rukh_": "Rukh3D",
    "schwaab_": "Mateus Schwaab",
    "space_survivor": "s.probka",
    "stakler_": "Stakler",
    "sumerian_": "Amazon",
    "tnua_": "I. Arye",
    "ulysses_": "eb78",
    "uxr_": "VRMADA",
    "valve_": "Valve",
    "webxr": "Amazon",
    "wu_": "Clement Wu",
    "yuki_": "yukikoooo",
}
"""By the beginnings of names; the longest that fits counts."""
VALID = ("AIAN", "Asian", "Black", "Hispanic", "MENA", "White", "X_", "valid")
PACK = "_pack__"
"""In names of the train set: Quaternius, as `modular_men` and `modular_women`."""


def maker_of(name: str) -> str:
    """Return the maker of a character.

    Raises
    ------
    KeyError
        A name whose maker is not listed.
    """
    if name.startswith(VALID):
        return "VALID"
    if PACK in name or name.startswith("modular_"):
        return "Quaternius"
    fitting = [start for start in MAKERS if name.startswith(start)]
    if not fitting:
        raise KeyError(f"{name}: add its maker to {__file__}")
    return MAKERS[max(fitting, key=len)]
