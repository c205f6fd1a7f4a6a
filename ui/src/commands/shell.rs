//! `pickglass completions` and `pickglass man`: the grammar for shells and for `man`.

use anyhow::Context;
use clap::CommandFactory;
use clap_mangen::Man;
use pickglass::atomic;

use crate::cli::{Cli, CompletionsArgs, ManArgs};
use crate::out;

/// Prints what a shell needs to complete command lines.
pub fn completions(args: &CompletionsArgs) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "pickglass", &mut script);
    out::say_text(&String::from_utf8_lossy(&script))
}

/// Writes a man page for the program and for each command.
pub fn man(args: &ManArgs) -> anyhow::Result<()> {
    let folder = &args.folder;
    std::fs::create_dir_all(folder).with_context(|| {
        format!(
            "{}: cannot be made: name another folder",
            out::shown(folder)
        )
    })?;
    let mut lines = Vec::new();
    for (name, page) in pages()? {
        let path = folder.join(name);
        atomic::write(&path, &page)?;
        lines.push(out::shown(&path));
    }
    out::say(&lines)
}

/// All man pages, by the names of their files.
fn pages() -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let mut program = Cli::command().disable_help_subcommand(true);
    program.build();
    let commands: Vec<_> = (program.get_subcommands())
        .filter(|command| !command.is_hide_set())
        .cloned()
        .collect();
    (std::iter::once(program).chain(commands))
        .map(|command| {
            let man = Man::new(command);
            let mut page = Vec::new();
            man.render(&mut page)?;
            Ok((man.get_filename(), page))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap_complete::Shell;

    #[test]
    fn every_command_has_a_page_that_says_its_options() {
        let pages = pages().expect("pages");
        let page = |name: &str| {
            let found = pages.iter().find(|(known, _)| known == name);
            String::from_utf8(found.expect(name).1.clone()).expect("text")
        };
        let mut program = Cli::command();
        program.build();
        for command in program.get_subcommands() {
            if command.get_name() == "help" {
                continue;
            }
            let page = page(&format!("pickglass-{}.1", command.get_name()));
            for option in command.get_opts().filter(|option| !option.is_hide_set()) {
                let long = option.get_long().expect("a long name").replace('-', "\\-");
                assert!(page.contains(&format!("\\-\\-{long}")), "{long}");
            }
        }
        assert!(page("pickglass.1").contains("pickglass\\-still(1)"));
        assert!(page("pickglass-still.1").contains("roulette"));
        assert!(!page("pickglass.1").contains("smoke"), "hidden options");
    }

    #[test]
    fn shells_complete_commands_options_and_values() {
        for shell in [Shell::Bash, Shell::Fish, Shell::Zsh, Shell::PowerShell] {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "pickglass", &mut script);
            let script = String::from_utf8(script).expect("text");
            // PowerShell is told no values.
            let values = shell == Shell::PowerShell || script.contains("oblique");
            let names = script.contains("posterize") && script.contains("colourway");
            assert!(names && values, "{shell}");
        }
    }
}
