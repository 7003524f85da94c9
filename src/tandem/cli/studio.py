"""`tandem studio`: a local page to edit, plan and question a cell."""

from __future__ import annotations

import importlib.util
import threading
import webbrowser

import click

from tandem.errors import UsageError

NEEDED = ("starlette", "sse_starlette", "uvicorn")


@click.command("studio")
@click.argument("place", metavar="[CELL|FOLDER]", required=False, type=click.Path())
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    help="Port on this computer, 0 for any that is free; 8770 or, when that is in use, any.",
)
@click.option(
    "--browser/--no-browser", default=True, show_default=True, help="Open the page in the browser."
)
def studio_command(place: str | None, port: int | None, browser: bool) -> int:
    """Edit, plan and question a cell on a web page of this computer; nothing is asked of a network.

    \b
    Examples:
      tandem studio cell.yaml
      tandem studio line-3 --port 0 --no-browser

    Prints the address of the page, once it answers, and nothing else on stdout. Of a FOLDER all
    cells can be opened; of the present one when nothing is given. Ctrl-C ends it: what was not
    saved is kept beside its file and offered at the next start.
    """
    if missing := [name for name in NEEDED if importlib.util.find_spec(name) is None]:
        raise UsageError(
            f"the studio needs {', '.join(missing)}, which is not installed. Get it with:"
            " pip install 'tandem[studio]'"
        )
    from tandem.studio.folder import Folder
    from tandem.studio.server import serve

    def ready(address: str) -> None:
        click.echo(address)
        if browser:
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()

    for kept in serve(Folder(place or "."), port, ready):
        click.echo(f"what was not saved is kept in {kept}", err=True)
    return 0
