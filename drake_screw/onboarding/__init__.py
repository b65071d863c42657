"""A scenario for a robot model as it comes: arm, hand, table, start and work area are found."""

from drake_screw.onboarding.design import Design, design
from drake_screw.onboarding.save import write_scenario
from drake_screw.onboarding.write import assumptions, scenario_text

__all__ = ["Design", "assumptions", "design", "scenario_text", "write_scenario"]
