#!/usr/bin/env python3
"""The search for each network's budget: every recipe is trained with the same rates and numbers of epochs on the same data.

    pip install peelnet[ray]        and the program `peelnet` on the path, for the synthetic lists
    python3 benches/budgets.py out/budgets [--recipes nmt,medium] [--rows 1200000]

The folder gets the datasets (where they are not there yet), `budgets.csv` and `budgets.md`. Held-out scenes choose nothing: of the
others, whole scenes are set aside from the seed, and the budget with the least loss on them is chosen. Losses of different recipes
measure different things, so they are no comparison. What an earlier search gave is in docs/results.
"""

import argparse
import subprocess
from pathlib import Path

import pandas
from peelnet.ray import extract, tune

RECIPES = ["nmt", "dfaoit", "small", "medium", "large", "anchored-small", "anchored-medium", "thesis"]
RATES = [1e-3, 4e-3, 1.6e-2]
# A quarter, a half and all of the longest training.
EPOCHS = [20, 40, 80]
# The thesis's published settings are others: it is searched with those of the networks that learn from the same rows.
SETTINGS = {"thesis": {"batch": 8192, "schedule": "one-cycle"}}


def datasets(folder):
    """Synthetic lists and peeled scenes."""
    synthetic, peeled = folder / "synthetic", folder / "peeled"
    if not synthetic.exists():
        subprocess.run(["peelnet", "extract", "--synthetic", "204800", "--out", synthetic], check=True)
    if not peeled.exists():
        scenes = sorted(Path("data/scenes").glob("*.toml"))
        scenes = [scene for scene in scenes if not scene.stem.endswith("-held")]
        extract(scenes, peeled, size=(128, 96), augment=3, pixels=0.25)
    return [synthetic, peeled]


def search(recipe, data, rows):
    """A row for each budget. A rate at which the training diverges ends the search with an error that names it."""
    fixed = {"recipe": recipe, "max_rows": rows, **SETTINGS.get(recipe, {})}
    found = []
    for epochs in EPOCHS:
        # No trial is stopped early: a short training is a budget of its own.
        tuned = tune({**fixed, "lr": RATES}, data, epochs=epochs, grace=epochs)
        trials = tuned.trials[["lr", "error", "epochs"]]
        found.append(trials.assign(recipe=recipe, epochs=epochs))
        print(found[-1].to_string(index=False), flush=True)
    return pandas.concat(found, ignore_index=True)


def markdown(found):
    """A line for each recipe and number of epochs; the chosen budget is in bold."""
    lines = ["| recipe | epochs |" + "".join(f" rate {rate:g} |" for rate in RATES), "|---|---:" + "|---:" * len(RATES) + "|"]
    for recipe, own in found.groupby("recipe", sort=False):
        least = own["error"].min()
        for epochs, row in own.groupby("epochs"):
            errors = row.set_index("lr")["error"]
            cells = [f"{errors[rate]:.4e}" for rate in RATES]
            cells = [f"**{cell}**" if errors[rate] == least else cell for cell, rate in zip(cells, RATES)]
            lines.append(f"| {recipe} | {epochs} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path)
    parser.add_argument("--recipes", default=",".join(RECIPES), help="names, separated by commas")
    parser.add_argument("--rows", type=int, default=1_200_000, help="rows of the datasets that are used at most")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    data = datasets(args.out)
    found = []
    for recipe in args.recipes.split(","):
        found.append(search(recipe, data, args.rows))
        # What is done is kept where the rest is interrupted.
        table = pandas.concat(found, ignore_index=True)
        table.to_csv(args.out / "budgets.csv", index=False)
        (args.out / "budgets.md").write_text(markdown(table))


if __name__ == "__main__":
    main()
