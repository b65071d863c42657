"""What a scenario would do, piece by piece, in numbers and words."""

from __future__ import annotations

from dataclasses import dataclass

from drake_screw.errors import counted

ASKED_FIRST = {
    "random": "at a random place",
    "middle": "in the middle",
    "farthest": "at the corner farthest from the shoulder",
}
"""Where the first demonstration is asked for, in words."""


@dataclass(frozen=True)
class PreviewedArm:
    """An arm: its model's name, its joints and end effector, and its reach in m.

    Of one among several also its name, and what it holds.
    """

    model: str
    joints: tuple[str, ...]
    end_effector: str
    reach: float
    name: str | None = None
    tool: PreviewedTool | None = None

    def __str__(self) -> str:
        joints = counted(len(self.joints), "joint")
        of = "" if self.name is None else f"arm {self.name}: "
        return f"{of}{self.model}, {joints}, end effector '{self.end_effector}'"


@dataclass(frozen=True)
class PreviewedObject:
    """Where an object may stand: least and greatest x, y, z in m; yaw, roll, pitch in rad.

    `z` is one number where it is fixed. `any_orientation`: whether angles are of a rotation that is
    uniform on SO(3). `on`: the object from which all are seen; None for the world.
    """

    name: str
    x: tuple[float, float]
    y: tuple[float, float]
    yaw: tuple[float, float]
    z: float | tuple[float, float]
    roll: tuple[float, float]
    pitch: tuple[float, float]
    any_orientation: bool
    on: str | None

    def __str__(self) -> str:
        ranges = []
        for axis, unit in _UNITS.items():
            value = getattr(self, axis)
            lower, upper = value if isinstance(value, tuple) else (value, value)
            if self.any_orientation and unit == "rad":
                continue
            if axis in ("roll", "pitch") and lower == upper == 0.0:
                continue
            least = f"{lower:.4g}" if axis == "z" else f"{lower:g}"
            numbers = f"{lower:g}..{upper:g}" if lower < upper else least
            ranges.append(f"{axis} {numbers} {unit}")
        if self.any_orientation:
            ranges.append("turned in any way")
        on = "" if self.on is None else f" on {self.on}"
        return f"{self.name}{on}: {', '.join(ranges)}"


_UNITS = {"x": "m", "y": "m", "yaw": "rad", "z": "m", "roll": "rad", "pitch": "rad"}


@dataclass(frozen=True)
class PreviewedTool:
    """What the end effector holds: its shape in words, its frame's name, what it may touch."""

    shape: str
    frame: str
    touches: tuple[str, ...]

    def __str__(self) -> str:
        touches = f", may touch {', '.join(self.touches)}" if self.touches else ""
        return f"{self.shape}, fixed to '{self.frame}'{touches}"


@dataclass(frozen=True)
class PreviewedObstacle:
    """A thing that stands around: its shape in words, x, y, z in m; roll, pitch, yaw in rad."""

    name: str
    shape: str
    xyz: tuple[float, float, float]
    rpy: tuple[float, float, float]

    def __str__(self) -> str:
        x, y, z = self.xyz
        turned = ", ".join(f"{angle:g}" for angle in self.rpy)
        how = f", turned by {turned} rad" if any(self.rpy) else ""
        return f"{self.name}: {self.shape} at {x:g}, {y:g}, {z:g} m{how}"


@dataclass(frozen=True)
class PreviewedTree:
    """Adaptive regions: free axes, the smallest cell's share of the area, its failure level."""

    axes: int
    smallest: float
    level: float

    def __str__(self) -> str:
        axes = f"{self.axes} {'axis' if self.axes == 1 else 'axes'}"
        return (
            f"adaptive: the work area is halved along its {axes} wherever something fails, down to "
            f"{self.smallest:.4g} of it; a cell that fails {self.level:g} of the time is noticed"
        )


@dataclass(frozen=True)
class PreviewedSamples:
    """Instances of a round, as far as a strategy says beforehand.

    Attributes:
        round: of a round in which nothing fails; None if it cannot be said.
        region: of each region in such a round; None where regions are adaptive.
        region_at_most: of a region before one is judged; None if there is no bound.
    """

    round: int | None = None
    region: int | None = None
    region_at_most: int | None = None

    @property
    def fixed(self) -> bool:
        """Whether every round takes the same."""
        return self.region is not None and self.region == self.region_at_most

    def __str__(self) -> str:
        if self.round is None:
            return "as many a round as it takes"
        if self.region is None:
            return (
                f"{self.round:,} in a first round where nothing fails, otherwise as many as it "
                "takes"
            )
        if self.fixed:
            return f"{self.region:,} in each region, {self.round:,} a round, every round"
        return (
            f"{self.round:,} in a first round where nothing fails ({self.region} in each region), "
            f"some thousands where something does, never over {self.region_at_most:,} in a region "
            "before one is flagged"
        )
