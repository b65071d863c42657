"""Pictures of a run: heat maps by matplotlib, the workcell in Meshcat."""

from drake_screw.visualization.heat_map import draw_heat_map
from drake_screw.visualization.heat_map_figure import heat_map_figure, save_heat_map
from drake_screw.visualization.progress import draw_progress, run_figure, save_run_figure
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
