"""The makers of the characters in ../shared/data."""

from __future__ import annotations

import re

from cutcell.errors import ParameterError

MAKERS = {
    "abbott_": "danielabbott",
    "adan_": "Adan",
    "adv_": "Kay Lousberg",
    "almaral_": "Denys Almaral",
    "animals_pack__": "Quaternius",
    "babylon": "Babylon.js",
    "bamba_": "Bamba_Negra",
    "barav_": "BaraV",
    "boxman": "J. Blaha",
    "bubba": "Hasksoft",
    "creator_": "creator830",
    "cute_fish_pack__": "Quaternius",
    "cyberpunk_pack__": "Quaternius",
    "darby_": "Elyse Darby",
    "dcl_": "Decentraland",
    "deok_": "Quaternius",
    "dinosaurs_pack__": "Quaternius",
    "djmaesen_": "DJMaesen",
    "duck_": "Friendl-e-Duck",
    "duznot_": "Duznot",
    "easy_enemies_pack__": "Quaternius",
    "elefante_": "planeta-elefante",
    "emoji": "Microsoft",
    "fish_pack__": "Quaternius",
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
    "mech_pack__": "Quaternius",
    "minnyquinn": "Cat Prisbrey",
    "modular_men": "Quaternius",
    "modular_women": "Quaternius",
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
    "platformer_game_pack__": "Quaternius",
    "pmndrs_low_poly_horse": "unknown (horse)",
    "pmndrs_skater": "Kenney",
    "polyme": "W. Yip",
    "pumpkin_": "outcast945",
    "quat": "Quaternius",
    "ramirez_": "M. Ramirez",
    "red_panda": "galiulinEldar",
    "rukh_": "Rukh3D",
    "schwaab_": "Mateus Schwaab",
    "single_knight_pack__": "Quaternius",
    "space_survivor": "s.probka",
    "stakler_": "Stakler",
    "sumerian_": "Amazon",
    "tank_pack__": "Quaternius",
    "tnua_": "I. Arye",
    "ultimate_space_pack__": "Quaternius",
    "ulysses_": "eb78",
    "uxr_": "VRMADA",
    "valid_": "VALID",
    "valve_": "Valve",
    "webxr": "Amazon",
    "wu_": "Clement Wu",
    "yuki_": "yukikoooo",
}
"""By the beginnings of names; the longest that fits counts."""
VALID = re.compile(r"(X_)?(AIAN|Asian|Black|Hispanic|MENA|NHPI|White)_[FM]_")
"""Beginnings of names in the train set: VALID."""


def maker_of(name: str) -> str:
    """Return the maker of a character.

    Raises
    ------
    ParameterError
        A name whose maker is not listed.
    """
    if VALID.match(name):
        return "VALID"
    fitting = [start for start in MAKERS if name.startswith(start)]
    if not fitting:
        raise ParameterError(f'no maker is listed for "{name}"; add one to MAKERS in {__file__}')
    return MAKERS[max(fitting, key=len)]
