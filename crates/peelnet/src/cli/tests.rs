use super::*;
use clap::CommandFactory as _;

/// Flags that no example has.
const OTHERS: &str = "
  peelnet run a.toml b.toml --out o --full --rows 9 --adapter software
  peelnet extract a.toml --out d --views 2 --peel dual --max-passes 3
  peelnet seal d --quiet --json
  peelnet train d --out m --stream --buffer-rows 1000 --split pixel --schedule one-cycle
  peelnet train d --out m --recipe small --hidden 4,3 --loss image --batch 64 --lr 1e-3 --max-rows 1000 --patience 3
  peelnet export m --out w --precision f16 --lang glsl-es
  peelnet bench designs d,e s --out o --file f.toml --max-rows 1000
  peelnet bench s --out d --resume --samples 4
  peelnet view cups --camera -1,0,6,0,0,0,30 --time 40
  peelnet inspect x --time
";

/// The declaration is sound, and every example in a help text is a command line that is read; every command has one.
#[test]
fn examples_in_help_texts_are_read() {
    let mut command = Cli::command();
    command.clone().debug_assert();
    let help_of = |command: &clap::Command| {
        let help = command.get_after_help();
        help.map_or_else(String::new, ToString::to_string)
    };
    let mut examples = help_of(&command) + OTHERS;
    for command in command.get_subcommands_mut() {
        let (help, name) = (help_of(command), command.get_name());
        let start = format!("  peelnet {name} ");
        assert!(help.contains(&start) || name == "doctor", "{start}");
        examples += &help;
        for below in command.get_subcommands() {
            let (help, start) = (help_of(below), format!("{start}{} ", below.get_name()));
            assert!(help.contains(&start), "{start}");
            examples += &help;
        }
    }
    let lines = examples.lines();
    for line in lines.filter_map(|line| line.strip_prefix("  peelnet ")) {
        // What it does stands beside some, what takes its JSON behind others.
        let line = line.split("   ").next().unwrap_or_default();
        let line = line.split(" | ").next().unwrap_or_default();
        let words = std::iter::once("peelnet").chain(line.split_whitespace());
        assert!(Cli::try_parse_from(words).is_ok(), "{line}");
    }
}
