"""Work areas, their regions, and task instances drawn from them."""

from drake_screw.tasks.boxes import BoxRegions, box_regions, free_axes, from_unit_box
from drake_screw.tasks.regions import GridRegions, Regions, grid_regions
from drake_screw.tasks.sampling import chance, draw, draw_in_all, uniform
from drake_screw.tasks.symmetry import Symmetry
from drake_screw.tasks.work_area import AXES, ObjectArea, WorkArea

__all__ = [
    "AXES",
    "BoxRegions",
    "GridRegions",
    "ObjectArea",
    "Regions",
    "Symmetry",
    "WorkArea",
    "box_regions",
    "chance",
    "draw",
    "draw_in_all",
    "free_axes",
    "from_unit_box",
    "grid_regions",
    "uniform",
]
