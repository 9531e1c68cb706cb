"""Parts of hand-made SVG figures: colours, text, axes and curves; equal data give equal bytes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from math import ceil, floor, isfinite, log10

# Of each method on a light and on a dark page. Neighbours differ for colour-blind readers in hue or
# lightness (Okabe and Ito, and Tol's muted palette); black is for what was measured.
PALETTE = (
    *(("#0072b2", "#56b4e9"), ("#d55e00", "#ff8c42"), ("#009e73", "#2fd0a0")),
    *(("#b0458c", "#ec8cc9"), ("#b07d00", "#f0c040"), ("#4b3fa7", "#a79bff")),
    *(("#882255", "#e0608f"), ("#4a9ed6", "#a6d8ff"), ("#6b6b00", "#cfcf55")),
    *(("#7a4a22", "#c99a6b"), ("#117777", "#5fb8b8"), ("#777777", "#aaaaaa")),
)
# Without a page around it (`--figures`), a figure is drawn with these rules alone.
RULES = (
    "svg{color:#1a1a1a;background:#fff;font:11px system-ui,sans-serif}"
    "text{fill:currentColor}.m{fill:#666}.e{text-anchor:end}.c{text-anchor:middle}.b{font-weight:600}"
    ".g{stroke:#e2e2e2;fill:none}.d{stroke:currentColor;stroke-dasharray:4 3;fill:none}"
    ".l{fill:none;stroke:var(--c);stroke-width:1.2;vector-effect:non-scaling-stroke}"
    ".a{stroke:#999;stroke-width:2}.f{fill:var(--c)}.s{stroke:var(--c);stroke-width:1.6}"
    ".h{fill:none;stroke:var(--c);stroke-width:1.3}.w{fill:#fff}.x{fill:none}"
    ".t1{stroke-dasharray:6 3}.t2{stroke-dasharray:2 3}"
)


def variables(theme: int) -> str:
    """The colours of the methods as CSS variables, on a light (0) or on a dark page (1)."""
    return "".join(f"--m{i}:{colours[theme]};" for i, colours in enumerate(PALETTE))


def classes() -> str:
    """The rules that give an element of the class `cN` the colour of method N."""
    return "".join(f".c{i}{{--c:var(--m{i})}}" for i in range(len(PALETTE)))


def colour(index: int | None) -> str:
    """The class of a method by its number in the report; None stands for what was measured."""
    if index is None:
        return "a"
    turn = min(index // len(PALETTE), 2)
    return f"c{index % len(PALETTE)}" + (f" t{turn}" if turn else "")


def element(width: float, height: float, label: str, body: Iterable[str], kind: str = "") -> str:
    """An `<svg>` element that fills the width of its place, with a name for those who hear it."""
    of_kind = f' class="{kind}"' if kind else ""
    opening = f'<svg viewBox="0 0 {short(width)} {short(height)}"{of_kind} role="img" aria-label='
    return f'{opening}"{escape(label)}">{"".join(body)}</svg>'


def text(x: float, y: float, words: str, kind: str = "") -> str:
    """Words at a place; the class `e` ends there, and `c` is centred there."""
    of_kind = f' class="{kind}"' if kind else ""
    return f'<text x="{short(x)}" y="{short(y)}"{of_kind}>{escape(words)}</text>'


def line(x1: float, y1: float, x2: float, y2: float, kind: str) -> str:
    """A straight line."""
    return f'<path d="M{short(x1)} {short(y1)}L{short(x2)} {short(y2)}" class="{kind}"/>'


def short(value: float) -> str:
    """A coordinate to a tenth."""
    return f"{value + 0.0:.1f}".removesuffix(".0").replace("-0.0", "0")


def ticks(low: float, high: float, count: int = 4) -> list[tuple[float, str]]:
    """About so many round values between the limits, with their texts."""
    if not (isfinite(high - low) and high > low):
        return [(low, f"{low:.4g}")]
    rough = (high - low) / count
    power = 10.0 ** floor(log10(rough))
    step = next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= rough * (1 - 1e-9))
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    places = max(0, -floor(log10(step) + 1e-9))
    return [(k * step, _label(k * step, places)) for k in range(first, last + 1)]


def _label(value: float, places: int) -> str:
    if places > 5 or abs(value) >= 1e6:
        return f"{value:.3g}"
    return f"{value + 0.0:.{places}f}"


def padded(values: Sequence[float], part: float = 0.08) -> tuple[float, float]:
    """The least and the greatest value with a margin; of equal ones, a range around them."""
    known = [x for x in values if isfinite(x)]
    low, high = (min(known), max(known)) if known else (0.0, 1.0)
    margin = part * (high - low) or 0.1 * abs(high) or 1.0
    return low - margin, high + margin
