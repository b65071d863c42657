"""Work areas, their regions, and task instances drawn from them."""

from drake_screw.tasks.regions import GridRegions, grid_regions
from drake_screw.tasks.sampling import draw
from drake_screw.tasks.work_area import AXES, ObjectArea, WorkArea

__all__ = ["AXES", "GridRegions", "ObjectArea", "WorkArea", "draw", "grid_regions"]
