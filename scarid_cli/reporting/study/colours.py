"""One colour for each method, on a light and on a dark page."""

from __future__ import annotations

# Of each pair the first is for a light page, the second for a dark one, with a contrast of at least
# 3. The first nine were searched for the largest distances as readers with each kind of colour
# blindness see them (tests/unit/test_report_colours.py); those beyond differ in their dashes too.
PALETTE = (
    ("#0072b2", "#56b4e9"),
    ("#d55e00", "#ff8c42"),
    ("#009e73", "#2fd0a0"),
    ("#2200ee", "#6644ee"),
    ("#662244", "#aa4444"),
    ("#004400", "#eeee00"),
    ("#aa44ee", "#cc0088"),
    ("#0044aa", "#cc0000"),
    ("#cc2244", "#4488ee"),
    ("#aa88aa", "#aaeeee"),
    ("#aa0088", "#ccee88"),
    ("#8888ee", "#cc8866"),
)
GOLDEN_ANGLE = 137.508  # degrees between the hues beyond the palette, so that none is repeated
DASHES = ("none", "7 3", "2 3", "9 3 2 3")


def colours_of(number: int) -> tuple[str, str]:
    """The colour of a method on a light and on a dark page; no two methods share one."""
    if number < len(PALETTE):
        return PALETTE[number]
    hue = round(GOLDEN_ANGLE * number % 360.0, 2)
    return f"hsl({hue} 65% 36%)", f"hsl({hue} 65% 66%)"


def rules(count: int) -> str:
    """The style sheet that gives each of so many methods its colour and its dashes."""
    light, dark = [], []
    for number in range(count):
        on_light, on_dark = colours_of(number)
        dashes = DASHES[number // 6 % len(DASHES)]
        light.append(f".m{number}{{--c:{on_light};--dash:{dashes}}}")
        dark.append(f".m{number}{{--c:{on_dark}}}")
    screen = "@media screen and (prefers-color-scheme:dark){" + "".join(dark) + "}"
    return "\n".join(("".join(light), screen))
