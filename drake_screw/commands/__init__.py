"""What the ``drake-screw`` command does, a module for each verb."""
