//! The declaration of the command line.

use super::*;
use clap::CommandFactory as _;

/// The declaration is sound, and every example in a help text is a command line that is read; every command has one.
#[test]
fn examples_in_help_texts_are_read() {
    let mut command = Cli::command();
    command.clone().debug_assert();
    let mut examples = command
        .get_after_help()
        .map_or_else(String::new, ToString::to_string);
    for command in command.get_subcommands_mut() {
        let help = command
            .get_after_help()
            .map_or_else(String::new, ToString::to_string);
        let start = format!("  peelnet {} ", command.get_name());
        assert!(
            help.contains(&start) || command.get_name() == "doctor",
            "{start}"
        );
        examples += &help;
    }
    for line in examples
        .lines()
        .filter_map(|line| line.strip_prefix("  peelnet "))
    {
        // What it does stands beside some, what takes its JSON behind others.
        let line = line.split("   ").next().unwrap_or_default();
        let line = line.split(" | ").next().unwrap_or_default();
        let words = std::iter::once("peelnet").chain(line.split_whitespace());
        assert!(Cli::try_parse_from(words).is_ok(), "{line}");
    }
}

#[test]
fn flags_that_no_example_has() {
    for line in [
        "run a.toml b.toml --out o --full --rows 9 --adapter software",
        "extract a.toml --out d --views 2 --peel dual --max-passes 3",
        "seal d --quiet --json",
        "train d --out m --stream --buffer-rows 1000 --split pixel --schedule one-cycle",
        "train d --out m --recipe small --hidden 4,3 --loss image --batch 64 --lr 1e-3 --max-rows 1000 --patience 3",
        "export m --out w --precision f16 --lang glsl-es",
        "bench --redraw --out d",
        "bench --designs d,e s --out o --designs-file f.toml --max-rows 1000",
        "bench s --out d --resume --samples 4",
        "view cups --camera -1,0,6,0,0,0,30 --time 40",
        "inspect x --time",
    ] {
        let words = std::iter::once("peelnet").chain(line.split(' '));
        assert!(Cli::try_parse_from(words).is_ok(), "{line}");
    }
}
