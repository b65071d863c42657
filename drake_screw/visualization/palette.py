"""Colours that stay apart for colour-blind people, shared by figures and Meshcat.

Every colour is sRGB. Meshcat takes the colours of points and of vertices as linear light, those of
materials (`Rgba`) as sRGB: pass the former through `linear_from_srgb`.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from drake_screw.planning import Cause
from drake_screw.typing import Array
from drake_screw.visualization.attempt import AHEAD, DONE, FAILED

if TYPE_CHECKING:
    from matplotlib.colors import Colormap, Normalize

OUTCOME_COLORS = MappingProxyType(
    {
        Cause.SUCCESS: "#00795a",
        Cause.JOINT_LIMIT: "#d55e00",
        Cause.UNREACHABLE: "#7cc8ff",
        Cause.COLLISION: "#111111",
        Cause.NOT_TRIED: "#8a8a8a",
        Cause.EXECUTION: "#961ee1",
    }
)
OUTCOME_NAMES = MappingProxyType(
    {
        Cause.SUCCESS: "success",
        Cause.JOINT_LIMIT: "joint limit",
        Cause.UNREACHABLE: "unreachable",
        Cause.COLLISION: "collision",
        Cause.NOT_TRIED: "not tried",
        Cause.EXECUTION: "execution",
    }
)
STATUS_COLORS = MappingProxyType(
    {
        DONE: OUTCOME_COLORS[Cause.SUCCESS],
        FAILED: OUTCOME_COLORS[Cause.JOINT_LIMIT],
        AHEAD: OUTCOME_COLORS[Cause.NOT_TRIED],
    }
)
"""Of screw segments; the ghost and the joint at its limit have that of what failed."""
ACCENT = "#ffd60a"
"""The suggested instance."""
INK = "#1c1b22"
PAPER = "#ffffff"
UNKNOWN = "#d9d9d9"
"""A region without samples."""
QUIET = "#8a8a8a"
"""What is there, but does not count."""
OBJECT_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9")
"""Of objects, in their order (Okabe and Ito)."""


def failure_map() -> Colormap:
    """Matplotlib colour map of failure probability: 0 is nearly white, 1 is dark purple.

    Lightness falls steadily along it (Brewer's BuPu), so it also works without colour vision and
    in grey print. NaN, a region without samples, is grey.
    """
    import matplotlib as mpl  # takes long to import

    return mpl.colormaps["BuPu"].with_extremes(bad=UNKNOWN)


def failure_norm() -> Normalize:
    """Takes failure probabilities to places in `failure_map`: by their square root.

    A run is about the small ones, 0.01 beside 0.05 beside 0.2, which would all be nearly white.
    """
    from matplotlib.colors import PowerNorm

    return PowerNorm(0.5, 0.0, 1.0)


def failure_color(probability: ArrayLike) -> Array:
    """sRGB of failure probabilities in [0, 1] or NaN; (...) to (..., 3)."""
    place = np.sqrt(np.asarray(probability, dtype=float))
    return np.array(failure_map()(np.ma.masked_invalid(place)))[..., :3]


def failure_scale() -> list[str]:
    """Hexadecimal colours for a scale in HTML, even in the square root of the probability."""
    from matplotlib.colors import to_hex

    return [to_hex(color) for color in failure_color(np.linspace(0.0, 1.0, 9) ** 2)]


def ink_on(rgb: ArrayLike) -> str:
    """The one of `INK` and `PAPER` that reads better on an sRGB colour (3,)."""
    from matplotlib.colors import to_rgb

    contrasts = {text: contrast(to_rgb(text), rgb) for text in (INK, PAPER)}
    return max(contrasts, key=contrasts.__getitem__)


def contrast(first: ArrayLike, second: ArrayLike) -> float:
    """Contrast ratio, 1 to 21, of two sRGB colours (3,) as WCAG 2 defines it."""
    weights = np.array([0.2126, 0.7152, 0.0722])
    dark, light = sorted(float(linear_from_srgb(c) @ weights) for c in (first, second))
    return (light + 0.05) / (dark + 0.05)


def linear_from_srgb(rgb: ArrayLike) -> Array:
    """Linear light from sRGB in [0, 1], elementwise (IEC 61966-2-1)."""
    rgb = np.asarray(rgb, dtype=float)
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
