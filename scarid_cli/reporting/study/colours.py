"""One colour for each method, on a light and on a dark page."""

from __future__ import annotations

# Okabe and Ito's palette, darkened where it vanishes on white, then colours of Tol's muted one.
# Of each pair the first is for a light page, the second for a dark one: both have a contrast of at
# least 3 to the background.
PALETTE = (
    ("#0072b2", "#4ba3dd"),
    ("#c04f00", "#f08a3c"),
    ("#00805f", "#2fbf93"),
    ("#b0558a", "#e08fbd"),
    ("#9a6a00", "#e0aa2e"),
    ("#2b87ad", "#7cc8ee"),
    ("#882255", "#d46a9c"),
    ("#4b3fa0", "#9d92f0"),
    ("#5f6b00", "#b3bf3a"),
    ("#a8323e", "#f0727e"),
    ("#117733", "#5fc777"),
    ("#6b6b6b", "#b5b5b5"),
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
