"""The little picture in the browser's tab: a shape cut by cells."""

from urllib.parse import quote

_SVG = """
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 32 32">
  <rect width="32" height="32" rx="7" fill="#1b2028"/>
  <path d="M6 11h20M6 21h20M11 6v20M21 6v20"
    stroke="#ff6c0c" stroke-width="2" stroke-linecap="round"/>
  <circle cx="16" cy="16" r="9" fill="none" stroke="#90d2ec" stroke-width="2.4"/>
  <circle cx="11" cy="11" r="2" fill="#99cb43"/>
  <circle cx="21" cy="21" r="2" fill="#99cb43"/>
</svg>
"""
FAVICON = "data:image/svg+xml," + quote(_SVG.strip())
