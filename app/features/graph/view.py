"""The cutting plane, which other panels show as well."""

from ...looks.cut import plane_part, watch

__all__ = ["PARTS", "watch"]

PARTS = {"handles": plane_part}
