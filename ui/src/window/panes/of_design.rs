//! Which design something was found of, once the document may have gone on.

use std::cell::Cell;
use std::sync::Arc;

use pickglass::design::Design;
use pickglass::edit::Document;

/// The design that something was found of.
pub struct OfDesign {
    design: Arc<Design>,
    /// The last state of the document that it was held against, and what came of it.
    known: Cell<(u64, bool)>,
}

impl OfDesign {
    /// The design that a document shows now.
    pub fn new(document: &Document) -> Self {
        Self {
            design: Arc::clone(document.design()),
            known: Cell::new((document.revision(), true)),
        }
    }

    /// Whether a document shows it: undoing a change brings it back.
    pub fn is(&self, document: &Document) -> bool {
        let (revision, same) = self.known.get();
        if revision == document.revision() {
            return same;
        }
        let now = document.design();
        let same = Arc::ptr_eq(&self.design, now) || *self.design == **now;
        self.known.set((document.revision(), same));
        same
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pickglass::edit::Edit;
    use pickglass::presets;

    #[test]
    fn what_is_undone_is_the_same_design_again() {
        let design = presets::design("denim").expect("a name").expect("a design");
        let mut document = Document::new(design);
        let found = OfDesign::new(&document);
        assert!(found.is(&document));
        let edit = Edit::Rename("another".to_owned());
        document.apply(edit).expect("an edit");
        assert!(!found.is(&document) && !found.is(&document));
        document.undo();
        assert!(found.is(&document));
        document.redo();
        assert!(!found.is(&document));
    }
}
