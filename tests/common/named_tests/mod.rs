//! Tests by name: what a list says is tried somewhere has to be there.

use std::collections::HashSet;
use std::path::Path;

/// Whether `file::test` is a test, of the file itself or of a module within it.
pub fn is_test(named: &str) -> bool {
    let found = named.split_once("::");
    found.is_some_and(|(file, name)| tests_of(file).contains(name))
}

/// The functions of a file that are tests.
fn tests_of(file: &str) -> HashSet<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{file}: {error}"));
    let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{file}: {error}"));
    let mut tests = HashSet::new();
    collect(&parsed.items, &mut tests);
    tests
}

fn collect(items: &[syn::Item], tests: &mut HashSet<String>) {
    for item in items {
        match item {
            syn::Item::Fn(function) if function.attrs.iter().any(|a| a.path().is_ident("test")) => {
                tests.insert(function.sig.ident.to_string());
            }
            syn::Item::Mod(module) => {
                let within = module.content.as_ref();
                collect(within.map_or(&[][..], |(_, items)| items), tests);
            }
            _ => {}
        }
    }
}
