"""Sphinx directive ``command-reference``: what ``--help`` of every verb of drake-screw prints."""

import typer
from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx

from drake_screw.cli import app as drake_screw_app

PROGRAM = "drake-screw"


class CommandReference(Directive):
    def run(self) -> list[nodes.Node]:
        group = typer.main.get_group(drake_screw_app)
        above = typer.Context(group, info_name=PROGRAM, **group.context_settings)
        sections: list[nodes.Node] = [_help(above)]
        for name, command in group.commands.items():
            context = typer.Context(command, above, name, **command.context_settings)
            section = nodes.section("", nodes.title("", name), _help(context), ids=[name])
            self.state.document.note_implicit_target(section)
            sections.append(section)
        return sections


def _help(context: typer.Context) -> nodes.literal_block:
    text = context.get_help()
    return nodes.literal_block(text, text, language="text")


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_directive("command-reference", CommandReference)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
