//! The declaration of the command line.

use super::*;
use clap::CommandFactory as _;

#[test]
fn the_declaration_is_sound() {
    Cli::command().debug_assert();
}

#[test]
fn every_command_has_an_example_that_begins_with_its_name() {
    for command in Cli::command().get_subcommands() {
        if command.get_name() == "doctor" {
            continue;
        }
        let help = command.get_after_help().map(ToString::to_string);
        let start = format!("peelnet {} ", command.get_name());
        assert!(
            help.is_some_and(|h| h.contains(&start)),
            "{}",
            command.get_name()
        );
    }
}

#[test]
fn the_specified_flags_are_there() {
    for line in [
        "run --out o",
        "run a.toml b.toml --out o --full --adapter software",
        "extract a.toml --out d --size 64x48 --views 2 --format npy --peel dual --max-passes 3 --pixels 0.5 --augment 2 --seed 9 --shard 1/4",
        "extract --synthetic 1000 --out d --seed 3 --resume",
        "extract a.toml --out d --resume",
        "seal d --quiet --json",
        "train d --out m --stream --buffer-rows 1000",
        "train d e --out m --recipe thesis --hidden 4,3 --loss image --epochs 3 --batch 64 --lr 1e-3 --seed 2 --max-rows 1000 --resume --loss-curve a.csv --loss-curve a.svg",
        "export m --out w --lang wgsl --precision f32",
        "render s --out i.png --method wboit-eq9:targets=f32 --view 2 --size 8x8 -q",
        "bench s --out d --methods mboit4,wboit-eq9 --models m,n --frames 2 --size 8x8 --views 1",
        "bench --scaling --out d",
        "bench --redraw --out d",
        "bench --designs d,e s --out o --designs-file f.toml --max-rows 1000",
        "bench s --out d --resume",
        "stress --methods mboit4,deep-small --models m --json",
        "stress --model m --cases deep --out d",
        "recommend s --budget-ms 3 --max-error 1e-4 --max-bytes 32",
        "recommend s --results d --json",
        "inspect x --json",
        "inspect x --time",
        "doctor --json",
    ] {
        let words = std::iter::once("peelnet").chain(line.split(' '));
        assert!(Cli::try_parse_from(words).is_ok(), "{line}");
    }
}
