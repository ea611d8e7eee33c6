"""How the page looks: colours, type and spacing, in light and in dark."""

from typing import Any

from cutcell_viewers.palette import DARK, LIGHT, to_hex

NARROW = "@media (max-width: 599.95px)"
SHEET = "46dvh"
"""How high the sidebar is in a narrow window: a sheet at the bottom, the canvas above it."""

_SHEET = {
    # The scene that its sliders change stays visible and can be turned.
    "pointerEvents": "none",
    "& .MuiBackdrop-root": {"display": "none"},
    "& .MuiDrawer-paper": {
        "pointerEvents": "auto",
        "top": f"calc(100dvh - {SHEET}) !important",
        "bottom": "auto !important",
        "left": "0 !important",
        "right": "0 !important",
        "width": "100% !important",
        "height": f"{SHEET} !important",
        "maxHeight": SHEET,
        "borderTop": "1px solid var(--mui-palette-divider)",
        "boxShadow": "0 -4px 20px rgba(10, 20, 40, .18)",
    },
}

FOCUS = {"outline": "2px solid #e05a00", "outlineOffset": "1px"}
"""Outline of the element with keyboard focus, as in the style sheets."""

_NO_RIPPLE = {"defaultProps": {"disableFocusRipple": True}}
"""Focus is an outline that stays, and no pulse."""

_SHAPE = {
    "shape": {"borderRadius": 8},
    "typography": {
        "fontSize": 13,
        "h3": {"fontSize": "1.15rem", "fontWeight": 600, "letterSpacing": "-0.01em"},
        "button": {"textTransform": "none", "fontWeight": 500},
    },
    # A menu that fades away still takes the next click, wherever that goes: it is gone at once.
    "components": {
        "MuiDrawer": {
            "styleOverrides": {
                # Dark paper is as dark over the canvas as beside it.
                "paper": {"backgroundImage": "none"},
                # Elements over the top bar need no space below it.
                "modal": {
                    "& .MuiDrawer-paper > .MuiToolbar-root": {"display": "none"},
                    NARROW: _SHEET,
                },
            }
        },
        "MuiButtonBase": {"styleOverrides": {"root": {"&.Mui-focusVisible": FOCUS}}},
        **dict.fromkeys(
            ("MuiButton", "MuiIconButton", "MuiToggleButton", "MuiSwitch", "MuiCheckbox"),
            _NO_RIPPLE,
        ),
        # Sections come below the page's name; their regions have no names, so are no landmarks.
        "MuiAccordion": {
            "defaultProps": {
                "slotProps": {"heading": {"component": "h2"}, "region": {"role": None}}
            }
        },
        "MuiAccordionSummary": {
            "styleOverrides": {"root": {"&.Mui-focusVisible": {"backgroundColor": "transparent"}}}
        },
        "MuiSlider": {"styleOverrides": {"thumb": {"&.Mui-focusVisible": FOCUS}}},
        # The page's name is its first heading.
        "MuiTypography": {"defaultProps": {"variantMapping": {"h3": "h1", "h5": "div"}}},
        "MuiMenu": {"defaultProps": {"transitionDuration": {"enter": 160, "exit": 0}}},
    },
}

THEME: dict[str, Any] = {
    "light": {
        **_SHAPE,
        "palette": {
            "primary": {"main": "#17678c", "contrastText": "#ffffff"},
            "background": {"default": to_hex(LIGHT.top), "paper": "#ffffff"},
            "text": {"primary": "#1f2632", "secondary": "#5c6675"},
            "divider": "#dde3ea",
        },
    },
    "dark": {
        **_SHAPE,
        "palette": {
            "primary": {"main": "#90d2ec", "contrastText": "#10222c"},
            "background": {"default": to_hex(DARK.bottom), "paper": "#1b2028"},
            "text": {"primary": "#e8ecf3", "secondary": "#9aa5b5"},
            "divider": "#2f3743",
        },
    },
}

# The bar on top is as quiet as the page: no band of colour, a hairline below.
PAGE_STYLE: dict[str, Any] = {
    "& .header": {
        "backgroundColor": "background.paper",
        "backgroundImage": "none",
        "color": "text.primary",
        "boxShadow": "none",
        "borderBottom": "1px solid",
        "borderColor": "divider",
    },
    "& .header a, & .header .title": {"color": "inherit"},
    "& .header .MuiToolbar-root": {"minHeight": "52px", "margin": 0},
    "& .MuiToolbar-root": {"minHeight": "52px"},
    "& .sidebar": {"backgroundImage": "none", "borderColor": "divider"},
    # Height of the open sheet: frontend/page/mui.js.
    NARROW: {"& .main > .MuiBox-root": {"height": "calc(100dvh - var(--sheet, 0px)) !important"}},
}
