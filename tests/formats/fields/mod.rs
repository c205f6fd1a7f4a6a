//! The field rule: what a file says of size, place, scale, axes, orientation, colour,
//! transparency or yarns is honoured, warned about by name, or refused by name.
//!
//! All of `formats::field_tables` are walked. For each row a format's module makes a
//! file with the field's example and a twin without it, and reads both.

mod drafts;
mod exr;
mod images;
mod table;
mod volumes;

use pickglass::formats::field_table::{Field, Handling, Table};
use pickglass::formats::field_tables;
use std::path::{Path, PathBuf};

/// A file with a field and its twin without it, in a folder of the test's own.
pub struct Twins {
    /// The file that has the field.
    pub with: PathBuf,
    /// The same without it.
    pub without: PathBuf,
}

/// What reading a file gave: a text in which every difference of the result shows, and
/// the warnings; or the message of the refusal.
pub type Outcome = Result<(String, Vec<String>), String>;

/// Makes and reads the files of a format.
pub struct Walker {
    /// As its table says.
    pub format: &'static str,
    /// Writes the twins into a folder; the example stands in the file under the given name,
    /// which is the field's own but in the control.
    pub twins: fn(folder: &Path, field: &Field, written_name: &str) -> Twins,
    /// Reads one.
    pub read: fn(path: &Path) -> Outcome,
    /// Whether a field's name stands in the file as text, so that another name can be
    /// written for the control.
    pub named: bool,
}

/// Makes a row's twins, reads them and says what is wrong with its handling, if anything is.
fn fault(walker: &Walker, field: &Field, written_name: &str) -> Option<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let twins = (walker.twins)(folder.path(), field, written_name);
    judge(
        field,
        (walker.read)(&twins.with),
        (walker.read)(&twins.without),
    )
}

/// What is wrong when these are read with a field and without it.
fn judge(field: &Field, with: Outcome, without: Outcome) -> Option<String> {
    let name = field.name.to_lowercase();
    let names = |text: &String| text.to_lowercase().contains(&name);
    let without = match without {
        Ok(read) => read,
        Err(message) => return Some(format!("the twin is refused: {message}")),
    };
    match (field.handling, with) {
        (Handling::Honoured, Ok(read)) if read.0 != without.0 => None,
        (Handling::Honoured, Ok(_)) => Some("it changes nothing".to_owned()),
        (Handling::Warned, Ok(read)) if read.1.iter().any(names) => {
            let both = without.1.iter().any(names);
            both.then(|| "the twin is warned about as well".to_owned())
        }
        (Handling::Warned, Ok(read)) => Some(format!("no warning names it: {:?}", read.1)),
        (Handling::Refused, Err(message)) if message.trim_end().contains('\n') => {
            Some(format!("the refusal is not one line: {message}"))
        }
        (Handling::Refused, Err(message)) if names(&message) => None,
        (Handling::Refused, Err(message)) => {
            Some(format!("the refusal does not name it: {message}"))
        }
        (Handling::Refused, Ok(_)) => Some("it is not refused".to_owned()),
        (_, Err(message)) => Some(format!("it is refused: {message}")),
    }
}

fn walker_of<'w>(walkers: &'w [Walker], table: &Table) -> Option<&'w Walker> {
    walkers.iter().find(|walker| walker.format == table.format)
}

#[test]
fn every_field_of_every_table_is_honoured_warned_about_or_refused() {
    let walkers = table::walkers();
    let mut faults = Vec::new();
    for table in field_tables() {
        let Some(walker) = walker_of(&walkers, &table) else {
            faults.push(format!("{}: nothing walks its table", table.format));
            continue;
        };
        for field in table.fields {
            if let Some(fault) = fault(walker, field, field.name) {
                faults.push(format!("{} {}: {fault}", table.format, field.name));
            }
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// A field that the reader does not know is a row whose handling was removed. Where fields
/// have no names in the file, the twin stands for the file that is read past.
#[test]
fn a_field_that_is_not_handled_is_found() {
    let walkers = table::walkers();
    for table in field_tables() {
        let Some(walker) = walker_of(&walkers, &table) else {
            continue;
        };
        for field in table.fields {
            let found = if walker.named {
                fault(walker, field, &unknown(field.name))
            } else {
                let folder = tempfile::tempdir().expect("a folder");
                let twin = (walker.twins)(folder.path(), field, field.name).without;
                judge(field, (walker.read)(&twin), (walker.read)(&twin))
            };
            assert!(found.is_some(), "{} {}", table.format, field.name);
        }
    }
}

/// A name that no format has, as long as a field's and of its letters, but for the first.
fn unknown(name: &str) -> String {
    let mut letters = name.chars();
    letters.next();
    format!("x{}", letters.as_str())
}

#[test]
fn tables_and_walkers_belong_together_and_hold_each_row_once() {
    let (tables, walkers) = (field_tables(), table::walkers());
    for walker in &walkers {
        let known = tables.iter().any(|table| table.format == walker.format);
        assert!(known, "{}: a walker without a table", walker.format);
    }
    let mut rows: Vec<String> = (tables.iter())
        .flat_map(|table| table.fields.iter().map(move |field| (table.format, field)))
        .map(|(format, field)| {
            assert!(
                !field.example.is_empty() && !field.name.is_empty(),
                "{format}"
            );
            format!("{format} {} {}", field.name, field.example)
        })
        .collect();
    let all = rows.len();
    rows.sort();
    rows.dedup();
    assert_eq!(rows.len(), all, "a row stands twice");
}
