//! What readers of drafts had to decide for themselves, in a bounded number of lines.

/// Most warnings that are written out; a broken file can give one a line.
const MAX_WARNINGS: usize = 40;

/// What a reader had to decide for itself.
#[derive(Debug, Default)]
pub(in crate::formats) struct Warnings {
    list: Vec<String>,
    more: usize,
}

impl Warnings {
    pub fn at(&mut self, line: u32, what: impl AsRef<str>) {
        self.add(|| format!("line {line}: {}", what.as_ref()));
    }

    /// One warning more that nobody would read: not worth its words.
    pub fn flooded(&mut self) -> bool {
        let full = self.list.len() >= MAX_WARNINGS;
        self.more += usize::from(full);
        full
    }

    pub fn whole(&mut self, what: impl Into<String>) {
        self.add(|| what.into());
    }

    fn add(&mut self, what: impl FnOnce() -> String) {
        if self.list.len() < MAX_WARNINGS {
            self.list.push(what());
        } else {
            self.more += 1;
        }
    }

    pub fn finish(mut self) -> Vec<String> {
        if self.more > 0 {
            self.list
                .push(format!("and {} more of this kind", self.more));
        }
        self.list
    }
}
