"""The command line: one module per command, loaded when the command is called.

A module `cli/<name>.py` holds ``command``; its file name is the command's name. Mistakes in a
specification become one sentence on stderr and exit status 2, other failures exit status 1,
Ctrl-C 130.
"""

from __future__ import annotations

import warnings
from importlib import import_module
from importlib.resources import files
from typing import Any

import click

from microswim import __version__
from microswim.cli._terminal import prepared
from microswim.errors import MicroswimError, SpecError, nearest


class Failure(click.ClickException):
    """One sentence on stderr and an exit status."""

    exit_code: int

    def __init__(self, sentence: str, status: int) -> None:
        super().__init__(" ".join(sentence.split()))
        self.exit_code = status

    def show(self, file: Any = None) -> None:
        say("Error", self.message, "red")


def say(label: str, sentence: str, colour: str) -> None:
    """Print one labelled sentence on stderr, coloured on a terminal."""
    click.echo(f"{click.style(label + ':', fg=colour, bold=True)} {sentence}", err=True)


class Commands(click.Group):
    """The commands are the modules of this package."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        modules = (f.name for f in files(__name__).iterdir() if f.name.endswith(".py"))
        return sorted(m[:-3].replace("_", "-") for m in modules if not m.startswith("_"))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.list_commands(ctx):
            return None
        return import_module(f".{cmd_name.replace('-', '_')}", __name__).command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            hint = nearest(args[0], self.list_commands(ctx))
            raise click.UsageError(f"{error.message.rstrip('.')}; {hint}", ctx) from None

    def main(self, *args: Any, **more: Any) -> Any:
        with prepared():
            return super().main(*args, **more)

    def make_context(self, *args: Any, **more: Any) -> click.Context:
        try:
            return super().make_context(*args, **more)
        except click.exceptions.NoArgsIsHelpError:
            raise
        except click.UsageError as error:
            raise _in_one_sentence(error, "microswim") from None

    def invoke(self, ctx: click.Context) -> Any:
        with warnings.catch_warnings():
            _warn_in_sentences()
            try:
                return super().invoke(ctx)
            except click.UsageError as error:
                name = ctx.invoked_subcommand
                raise _in_one_sentence(
                    error, f"microswim {name}" if name else "microswim"
                ) from None
            except SpecError as error:
                raise Failure(str(error), 2) from None
            except MicroswimError as error:
                raise Failure(str(error), 1) from None
            except BrokenPipeError:
                raise
            except OSError as error:
                raise Failure(
                    f"{error.filename or 'the output'}: {error.strerror or error}", 1
                ) from None
            except KeyboardInterrupt:
                click.echo("interrupted", err=True)
                ctx.exit(130)


def _in_one_sentence(error: click.UsageError, command: str) -> Failure:
    """Return click's complaint about an option as one sentence with the place to look it up."""
    said = " ".join(error.format_message().split())
    said = said if said.endswith("...") else said.rstrip(". ")
    return Failure(f"{said}; see {command} --help", 2)


def _warn_in_sentences() -> None:
    """Show the package's own warnings as one yellow sentence each, once."""
    said: set[str] = set()
    usual = warnings.showwarning

    def show(message: Any, category: type[Warning], *where: Any, **more: Any) -> None:
        sentence = " ".join(str(message).split())
        if not category.__module__.startswith("microswim"):
            usual(message, category, *where, **more)
        elif sentence not in said:
            said.add(sentence)
            say("Warning", sentence, "yellow")

    warnings.simplefilter("always", UserWarning)
    warnings.showwarning = show


START = """\b
Start here:
  microswim demo                          the base-case swimmer swims
  microswim new robot.toml                a commented spec to start from
  microswim run robot.toml --out results  numbers, files, pictures, a report
"""


@click.group(cls=Commands, epilog=START, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, "--version", message="microswim %(version)s")
def main() -> None:
    """How bio-inspired micro-robots and flagellated cells swim in viscous fluid."""
