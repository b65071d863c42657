from drake_screw.errors import DrakeScrewError

__all__ = ["DrakeScrewError"]
