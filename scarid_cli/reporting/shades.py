"""One SVG for a light and for a dark page."""

from __future__ import annotations

# What is drawn on white, and what takes its place on a dark page. A program that does not know
# `prefers-color-scheme` shows the light picture.
DARK = {
    "#ffffff": "#0d1117",
    "#000000": "#ffffff",
    "#222222": "#e2e2e2",
    "#666666": "#9a9a9a",
    "#888888": "#8a8a8a",
    "#e4e4e4": "#30363d",
    "#0072b2": "#58b0ea",
    "#d55e00": "#f28c45",
    "#009e73": "#35c99a",
    "#cc79a7": "#e39cc4",
    "#e69f00": "#f0b840",
    "#56b4e9": "#8fd0f7",
    "#882255": "#d672a5",
}


def both(document: str) -> str:
    """The SVG document with the colours of a dark page where the reader prefers one."""
    rules = [
        f'[style*="{what}: {light}"]{{{what}:{dark}!important}}'
        for light, dark in DARK.items()
        for what in ("fill", "stroke")
        if f"{what}: {light}" in document
    ]
    style = f"<style>@media (prefers-color-scheme:dark){{{''.join(rules)}}}</style>"
    start = document.index(">", document.index("<svg")) + 1
    return document[:start] + style + document[start:]
