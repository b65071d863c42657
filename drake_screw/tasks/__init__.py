"""Work areas, their regions, and task instances drawn from them."""

from drake_screw.tasks.boxes import BoxRegions, box_regions, from_unit_box
from drake_screw.tasks.column_names import column_name, column_names, other_names
from drake_screw.tasks.object_area import ObjectArea
from drake_screw.tasks.regions import GridRegions, Regions, grid_regions
from drake_screw.tasks.sampling import anywhere, chance, draw, draw_in_all, uniform
from drake_screw.tasks.symmetry import Symmetry
from drake_screw.tasks.work_area import ANGLES, AXES, FARTHEST, PLANAR, Overlap, WorkArea

__all__ = [
    "ANGLES",
    "AXES",
    "FARTHEST",
    "PLANAR",
    "BoxRegions",
    "GridRegions",
    "ObjectArea",
    "Overlap",
    "Regions",
    "Symmetry",
    "WorkArea",
    "anywhere",
    "box_regions",
    "chance",
    "column_name",
    "column_names",
    "draw",
    "draw_in_all",
    "from_unit_box",
    "grid_regions",
    "other_names",
    "uniform",
]
