"""Pictures of a run: heat maps by matplotlib, the workcell in Meshcat."""

from typing import TYPE_CHECKING

from drake_screw.lazily import lazily

if TYPE_CHECKING:
    from drake_screw.visualization.heat_map import draw_heat_map
    from drake_screw.visualization.progress import draw_progress, run_figure, save_run_figure
    from drake_screw.visualization.round_figure import heat_map_figure, save_heat_map
    from drake_screw.visualization.rounds import Round
    from drake_screw.visualization.scene import Scene

__all__ = [
    "Round",
    "Scene",
    "draw_heat_map",
    "draw_progress",
    "heat_map_figure",
    "run_figure",
    "save_heat_map",
    "save_run_figure",
]

_MODULES = {
    "heat_map": ("draw_heat_map",),
    "round_figure": ("heat_map_figure", "save_heat_map"),
    "progress": ("draw_progress", "run_figure", "save_run_figure"),
    "rounds": ("Round",),
    "scene": ("Scene",),
}

__getattr__ = lazily(
    __name__, {name: f"{__name__}.{module}" for module, names in _MODULES.items() for name in names}
)
