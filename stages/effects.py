"""The command that shows the effect catalogue; not a stage of the pipeline."""

import argparse
import sys
from pathlib import Path
from typing import NoReturn

from simgap.errors import InputError
from simgap.runner.command import report_mistakes
from simgap.runner.project import nearest


def effects(kind: str | None = None, name: str | None = None) -> None:
    """List the effects that a diagnosis can name; with a kind and a name, describe one effect."""
    from simgap.effects import effect_by_key, effects_of, kinds
    from simgap.effects.listing import description, listing

    if kind is not None and kind not in kinds():
        raise InputError(f"unknown kind {kind!r}", remedy=_remedy(kind))
    if kind is None or name is None:
        print("\n".join(listing(each, effects_of(each)) for each in ([kind] if kind else kinds())), end="")
        return
    named = [effect for effect in effects_of(kind) if name in (effect.name, effect.key)]
    print("\n".join(map(description, named or [effect_by_key(kind, name)])), end="")


def write(path: Path) -> None:
    """Write the whole catalogue as a page in Markdown."""
    from simgap.effects.page import catalogue_page

    path.write_text(catalogue_page(), encoding="utf-8")
    print(f"effects: wrote {path}")


def _remedy(kind: str) -> str:
    """Say which kind was meant, or of which kinds the effect is that was named alone."""
    from simgap.effects import effects_of, kinds

    having = [each for each in kinds() if kind in {effect.name for effect in effects_of(each)}]
    return f"name a kind first: simgap effects {having[0]} {kind}" if having else nearest(kind, kinds())


def main(argv: list[str] | None = None) -> NoReturn:
    """Run the command line and exit."""
    parser = argparse.ArgumentParser(prog="simgap effects", description=effects.__doc__)
    parser.add_argument("kind", nargs="?", help="of platform: quadrotor, swerve or joint")
    parser.add_argument("name", nargs="?", help="of an effect")
    parser.add_argument(
        "--write", metavar="PATH", type=Path, help="write the catalogue as a page in Markdown"
    )
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    given = parser.parse_args(argv)
    action = (lambda: write(given.write)) if given.write else (lambda: effects(given.kind, given.name))
    sys.exit(report_mistakes("effects", given.debug, action))


if __name__ == "__main__":
    main()
