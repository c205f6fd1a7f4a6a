//! The house's rule: which folder of the library may import which, from top to bottom, and how
//! many files import each other in circles.
//!
//! The table stands in the documentation of `src/lib.rs`, one row a folder: its name, what it
//! is, and the folders that it imports. A row imports rows above it; an import from below is
//! written in italics and has still to go. The table is exact: an import that is not in it
//! fails, and so does one that it names and nobody needs any more.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use syn::visit::{self, Visit};

/// Files of the library that stand in a circle of imports. It may fall, never grow.
const MOST_IN_CIRCLES: usize = 74;

/// Names from the root of the crate to a module.
type Module = Vec<String>;

/// The library's sources.
#[derive(Default)]
struct House {
    files: BTreeMap<Module, syn::File>,
    /// What modules hand on under a name of their own: module, name → where it is from.
    handed_on: BTreeMap<(Module, String), Module>,
    /// Modules of which another hands on everything.
    opened: BTreeMap<Module, Vec<Module>>,
}

impl House {
    /// Reads sources by their paths below `src`. What is compiled for tests alone is left out.
    fn read(sources: &BTreeMap<String, String>) -> Self {
        let mut house = Self::default();
        for (path, source) in sources {
            let file = syn::parse_file(source).unwrap_or_else(|error| panic!("{path}: {error}"));
            house.files.insert(module_of(path), file);
        }
        let tests: Vec<Module> = (house.files.iter())
            .flat_map(|(module, file)| {
                let declared = file.items.iter().filter_map(|item| match item {
                    syn::Item::Mod(child) if for_tests(&child.attrs) => Some(&child.ident),
                    _ => None,
                });
                declared.map(|name| child(module, &name.to_string()))
            })
            .collect();
        (house.files).retain(|module, _| !tests.iter().any(|test| module.starts_with(test)));
        for (module, file) in &house.files {
            for item in &file.items {
                let syn::Item::Use(item) = item else { continue };
                if matches!(item.vis, syn::Visibility::Inherited) {
                    continue;
                }
                for (path, name) in flat(&item.tree) {
                    let path = from_root(module, path, &house.files);
                    match (path, name) {
                        (Some(path), Some(name)) => {
                            house.handed_on.insert((module.clone(), name), path);
                        }
                        (Some(path), None) => {
                            house.opened.entry(module.clone()).or_default().push(path);
                        }
                        (None, _) => {}
                    }
                }
            }
        }
        house
    }

    /// The file in which the last name of a path from the root is written.
    fn file_of(&self, path: &[String]) -> Module {
        self.file_within(path, 0).unwrap_or_default()
    }

    fn file_within(&self, path: &[String], depth: usize) -> Option<Module> {
        let mut module = Module::new();
        for (index, name) in path.iter().enumerate() {
            let below = child(&module, name);
            if self.files.contains_key(&below) {
                module = below;
                continue;
            }
            let rest = &path[index + 1..];
            let handed_on = self.handed_on.get(&(module.clone(), name.clone()));
            if let Some(from) = handed_on.filter(|_| depth < 8) {
                let whole: Vec<String> = from.iter().chain(rest).cloned().collect();
                return self.file_within(&whole, depth + 1);
            }
            return Some(self.writes(&module, name).unwrap_or(module));
        }
        Some(module)
    }

    /// Which of the modules that `module` opens writes `name`.
    fn writes(&self, module: &Module, name: &str) -> Option<Module> {
        let opened = self.opened.get(module)?;
        let found = opened.iter().find(|from| {
            let file = self.files.get(*from);
            file.is_some_and(|file| file.items.iter().any(|item| is_named(item, name)))
        });
        found.cloned()
    }

    /// Every file that another file names, by module, with the line of the first such name.
    fn imports(&self) -> BTreeMap<(Module, Module), usize> {
        let mut all = BTreeMap::new();
        for (module, file) in &self.files {
            let mut names = Names {
                module: module.clone(),
                files: &self.files,
                found: Vec::new(),
            };
            names.visit_file(file);
            for (path, line) in names.found {
                let to = self.file_of(&path);
                if to != *module && !to.is_empty() {
                    all.entry((module.clone(), to)).or_insert(line);
                }
            }
        }
        all
    }
}

/// The paths from the root that a file names.
struct Names<'a> {
    module: Module,
    files: &'a BTreeMap<Module, syn::File>,
    found: Vec<(Module, usize)>,
}

impl Names<'_> {
    fn add(&mut self, path: Vec<String>, span: proc_macro2::Span) {
        if let Some(path) = from_root(&self.module, path, self.files) {
            self.found.push((path, span.start().line));
        }
    }
}

impl<'ast> Visit<'ast> for Names<'_> {
    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if for_tests(&item.attrs) {
            return;
        }
        // What a folder hands on of its own is not used here.
        let handed_on = !matches!(item.vis, syn::Visibility::Inherited);
        for (path, _) in flat(&item.tree) {
            let Some(path) = from_root(&self.module, path, self.files) else {
                continue;
            };
            if !handed_on || path.first() != self.module.first() {
                self.found.push((path, item.use_token.span.start().line));
            }
        }
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if for_tests(&item.attrs) {
            return;
        }
        // Its `super` is this file.
        self.module.push(item.ident.to_string());
        visit::visit_item_mod(self, item);
        self.module.pop();
    }

    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        if !for_tests(&item.attrs) {
            visit::visit_item_fn(self, item);
        }
    }

    fn visit_item_impl(&mut self, item: &'ast syn::ItemImpl) {
        if !for_tests(&item.attrs) {
            visit::visit_item_impl(self, item);
        }
    }

    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {
        // Who may see a thing is not what it needs.
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.segments.len() > 1
            && let Some(first) = path.segments.first()
        {
            let names = path
                .segments
                .iter()
                .map(|segment| segment.ident.to_string());
            self.add(names.collect(), first.ident.span());
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        // What a macro is given has no grammar of its own: the paths in it are enough.
        let given: String = call.tokens.to_string().split_whitespace().collect();
        let line = call
            .path
            .segments
            .first()
            .map(|segment| segment.ident.span());
        for start in ["crate::", "super::"] {
            for (at, _) in given.match_indices(start) {
                let path = given[at..]
                    .split(|letter: char| !(letter.is_alphanumeric() || "_:".contains(letter)));
                let path = path.take(1).flat_map(|path| path.split("::"));
                let path = path.map(str::to_owned).filter(|name| !name.is_empty());
                self.add(
                    path.collect(),
                    line.unwrap_or_else(proc_macro2::Span::call_site),
                );
            }
        }
        visit::visit_macro(self, call);
    }
}

/// The module that a file below `src` holds.
fn module_of(path: &str) -> Module {
    let path = path.trim_end_matches(".rs");
    let path = path.trim_end_matches("/mod");
    (path.split('/').filter(|name| *name != "lib"))
        .map(str::to_owned)
        .collect()
}

fn child(module: &Module, name: &str) -> Module {
    module.iter().cloned().chain([name.to_owned()]).collect()
}

fn for_tests(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("test")
            || attribute.path().is_ident("cfg")
                && (attribute.meta.require_list())
                    .is_ok_and(|list| list.tokens.to_string() == "test")
    })
}

/// The paths of a `use`, each with the name that it gets; `None` for all that is there.
fn flat(tree: &syn::UseTree) -> Vec<(Vec<String>, Option<String>)> {
    match tree {
        syn::UseTree::Path(path) => {
            let first = path.ident.to_string();
            (flat(&path.tree).into_iter())
                .map(|(rest, name)| ([first.clone()].into_iter().chain(rest).collect(), name))
                .collect()
        }
        syn::UseTree::Name(name) => {
            vec![(vec![name.ident.to_string()], Some(name.ident.to_string()))]
        }
        syn::UseTree::Rename(name) => {
            vec![(vec![name.ident.to_string()], Some(name.rename.to_string()))]
        }
        syn::UseTree::Glob(_) => vec![(Vec::new(), None)],
        syn::UseTree::Group(group) => group.items.iter().flat_map(flat).collect(),
    }
}

/// A path as it is written in `module`, from the root; `None` for other crates' and for names
/// of this file alone.
fn from_root(
    module: &Module,
    path: Vec<String>,
    files: &BTreeMap<Module, syn::File>,
) -> Option<Module> {
    let first = path.first()?;
    let mut base = module.clone();
    let mut rest = path.as_slice();
    match first.as_str() {
        "crate" => {
            base.clear();
            rest = &rest[1..];
        }
        "self" => rest = &rest[1..],
        "super" => {
            while rest.first().is_some_and(|name| name == "super") {
                base.pop()?;
                rest = &rest[1..];
            }
        }
        name if files.contains_key(&child(module, name)) => {}
        _ => return None,
    }
    let rest = rest.iter().filter(|name| *name != "self").cloned();
    Some(base.into_iter().chain(rest).collect())
}

fn is_named(item: &syn::Item, name: &str) -> bool {
    let ident = match item {
        syn::Item::Const(item) => &item.ident,
        syn::Item::Enum(item) => &item.ident,
        syn::Item::Fn(item) => &item.sig.ident,
        syn::Item::Static(item) => &item.ident,
        syn::Item::Struct(item) => &item.ident,
        syn::Item::Trait(item) => &item.ident,
        syn::Item::Type(item) => &item.ident,
        _ => return false,
    };
    ident == name
}

/// Groups of files that import each other, directly or by others.
fn circles(edges: &BTreeSet<(Module, Module)>) -> Vec<Vec<Module>> {
    let mut next_of: BTreeMap<&Module, Vec<&Module>> = BTreeMap::new();
    for (from, to) in edges {
        next_of.entry(from).or_default().push(to);
    }
    let reached: BTreeMap<&Module, BTreeSet<&Module>> = (next_of.keys())
        .map(|start| {
            let mut seen = BTreeSet::new();
            let mut left = vec![*start];
            while let Some(node) = left.pop() {
                let next = next_of.get(node).into_iter().flatten();
                left.extend(next.filter(|to| seen.insert(**to)));
            }
            (*start, seen)
        })
        .collect();
    let mut groups: Vec<Vec<Module>> = Vec::new();
    for (node, others) in &reached {
        if !others.contains(node) || groups.iter().flatten().any(|seen| seen == *node) {
            continue;
        }
        let returns =
            |other: &&&Module| reached.get(**other).is_some_and(|back| back.contains(node));
        let group = others.iter().filter(returns);
        groups.push(group.map(|other| Module::clone(other)).collect());
    }
    groups
}

/// One row of the table: a folder, and the folders that it imports.
struct Row {
    folder: String,
    imports: BTreeSet<String>,
    /// Those of the imports that stand in italics.
    still_to_go: BTreeSet<String>,
}

/// The table of the library's documentation.
fn table(documentation: &str) -> Vec<Row> {
    let lines = documentation
        .lines()
        .filter_map(|line| line.strip_prefix("//! | "));
    let rows = lines.filter_map(|line| {
        let mut cells = line.split('|').map(str::trim);
        let (folder, _, imports) = (cells.next()?, cells.next()?, cells.next()?);
        let folder = folder.strip_prefix("[`")?.strip_suffix("`]")?;
        let folder = folder.trim_start_matches("mod@");
        let names = |italic: bool| {
            let words = imports.split_whitespace();
            let words = words.filter(move |word| word.starts_with('*') == italic || *word == "–");
            words
                .map(|word| word.trim_matches(['*', '`']).to_owned())
                .filter(|word| word != "–")
                .collect::<BTreeSet<String>>()
        };
        let still_to_go = names(true);
        let imports = names(false).union(&still_to_go).cloned().collect();
        Some(Row {
            folder: folder.to_owned(),
            imports,
            still_to_go,
        })
    });
    rows.collect()
}

/// What differs between the table and the sources, one line each.
fn faults(house: &House, rows: &[Row]) -> Vec<String> {
    let mut faults = Vec::new();
    let place = |folder: &str| rows.iter().position(|row| row.folder == folder);
    let mut needed: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let imports = house.imports();
    for ((from, to), line) in &imports {
        let (Some(folder), Some(other)) = (from.first(), to.first()) else {
            continue;
        };
        if folder == other {
            continue;
        }
        needed.entry(folder).or_default().insert(other);
        let row = rows.iter().find(|row| row.folder == *folder);
        if !row.is_some_and(|row| row.imports.contains(other)) {
            let from = from.join("/");
            faults.push(format!(
                "src/{from}.rs:{line}: `{folder}` may not import `{other}`"
            ));
        }
    }
    for folder in house.files.keys().filter_map(|module| module.first()) {
        if place(folder).is_none() {
            let fault = format!("`{folder}` has no row in the table of src/lib.rs");
            if !faults.contains(&fault) {
                faults.push(fault);
            }
        }
    }
    for (index, row) in rows.iter().enumerate() {
        for other in &row.imports {
            let Some(above) = place(other) else {
                faults.push(format!(
                    "the row of `{}` names `{other}`, which has none",
                    row.folder
                ));
                continue;
            };
            let needs = needed.get(row.folder.as_str());
            if !needs.is_some_and(|needs| needs.contains(other.as_str())) {
                faults.push(format!(
                    "`{}` no longer imports `{other}`: take it out",
                    row.folder
                ));
            }
            if (above > index) != row.still_to_go.contains(other) {
                faults.push(format!(
                    "the row of `{}` has `{other}` in italics, or not, and it stands {}",
                    row.folder,
                    if above > index { "below" } else { "above" },
                ));
            }
        }
    }
    faults
}

/// Every source of the library by its path below `src`.
fn sources() -> BTreeMap<String, String> {
    fn walk(folder: &Path, below: &str, found: &mut BTreeMap<String, String>) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let entry = entry.expect("an entry");
            let name = entry.file_name().into_string().expect("a plain name");
            let path = format!("{below}{name}");
            if entry.file_type().expect("a kind").is_dir() {
                walk(&entry.path(), &format!("{path}/"), found);
            } else if name.ends_with(".rs") {
                let source = std::fs::read_to_string(entry.path()).expect("text");
                found.insert(path, source);
            }
        }
    }
    let mut found = BTreeMap::new();
    walk(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("src"),
        "",
        &mut found,
    );
    found
}

#[test]
fn folders_import_what_the_table_says() {
    let sources = sources();
    let rows = table(&sources["lib.rs"]);
    assert!(rows.len() > 10, "the table was not found");
    let faults = faults(&House::read(&sources), &rows);
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn a_wrong_import_is_found() {
    let mut sources = sources();
    let rows = table(&sources["lib.rs"]);
    let wrong = [
        ("use crate::engine::Request;", "yarn", "engine"),
        ("use crate::{engine::Request};", "yarn", "engine"),
        ("fn f() { crate::render::trace(); }", "yarn", "render"),
        (
            "fn f() { assert!(crate::cloth::is() == 1); }",
            "yarn",
            "cloth",
        ),
        ("use super::super::formats::png;", "yarn", "formats"),
    ];
    for (line, folder, other) in wrong {
        let before = sources.insert("yarn/wrong.rs".to_owned(), line.to_owned());
        assert!(before.is_none());
        let found = faults(&House::read(&sources), &rows);
        let named = format!("src/{folder}/wrong.rs:1: `{folder}` may not import `{other}`");
        assert!(found.contains(&named), "{line}: {found:?}");
        sources.remove("yarn/wrong.rs");
    }
    // In tests a module may name whatever it needs.
    let test = "#[cfg(test)] mod tests { use crate::engine::Request; }";
    sources.insert("yarn/right.rs".to_owned(), test.to_owned());
    assert!(faults(&House::read(&sources), &rows).is_empty());
    sources.remove("yarn/right.rs");
    // A row that allows more than is needed.
    let mut rows = rows;
    let row = rows
        .iter_mut()
        .find(|row| row.folder == "render")
        .expect("a row");
    row.imports.insert("design".to_owned());
    let found = faults(&House::read(&sources), &rows);
    assert_eq!(found, ["`render` no longer imports `design`: take it out"]);
}

#[test]
fn circles_do_not_grow() {
    let house = House::read(&sources());
    let circles = circles(&house.imports().into_keys().collect());
    let files: usize = circles.iter().map(Vec::len).sum();
    for circle in &circles {
        let names: Vec<String> = circle.iter().map(|module| module.join("/")).collect();
        println!("{:>3} files: {}", names.len(), names.join(" "));
    }
    println!("{files} files in {} circles", circles.len());
    assert!(
        files <= MOST_IN_CIRCLES,
        "{files} files import each other, not {MOST_IN_CIRCLES}"
    );
}

#[test]
fn a_circle_is_found() {
    let source = |path: &str, text: &str| (path.to_owned(), text.to_owned());
    let sources = BTreeMap::from([
        source("lib.rs", "pub mod a;"),
        source("a/mod.rs", "mod b; mod c; pub use b::B; pub use c::*;"),
        source("a/b.rs", "use super::C; pub struct B;"),
        source("a/c.rs", "pub struct C(crate::a::B);"),
        source("a/d.rs", "use super::{B, C};"),
    ]);
    let house = House::read(&sources);
    let circles = circles(&house.imports().into_keys().collect());
    let [circle] = circles.as_slice() else {
        panic!("{circles:?}");
    };
    assert_eq!(
        circle
            .iter()
            .map(|module| module.join("/"))
            .collect::<Vec<_>>(),
        ["a/b", "a/c"]
    );
}
