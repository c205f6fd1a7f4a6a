//! What is open: the document, the file it belongs to, and what the file's reader said.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use pickglass::design::{
    Design, Draft, Family, Lifting, Shed, Srgb, Structure, Ties, Yarn, YarnId, YarnMaps,
    shafts_needed, usual_sett,
};
use pickglass::edit::Document;
use pickglass::text::visible;

use crate::opened::Opened;

/// Ends and picks of a new design.
const NEW_SIZE: u32 = 16;
/// The most shafts that a drawdown may need to be a draft, and the most crossings of one
/// that is asked.
const MOST_SHAFTS: u32 = 40;
const LARGEST_DERIVED: u64 = 1 << 20;
/// Shafts and treadles of a new design.
const SHAFTS: u16 = 4;

/// An open document.
pub struct Session {
    pub document: Document,
    /// The file that *Save* writes; `None` = ask for one.
    pub path: Option<PathBuf>,
    /// A file of another format that the design is from: never written over.
    pub source: Option<PathBuf>,
}

impl Session {
    /// A session of what was read. A file of another format is not written over: its
    /// design is saved under a new name.
    pub fn of(opened: &Opened) -> Self {
        Self {
            document: Document::new(Design::clone(&opened.design)),
            path: opened.path.clone().filter(|path| own_format(path)),
            source: opened.path.clone().filter(|path| !own_format(path)),
        }
    }

    /// A session of work that is in no file yet.
    pub fn unsaved(design: Design, path: Option<PathBuf>) -> Self {
        Self {
            document: Document::unsaved(design),
            path: path.filter(|path| own_format(path)),
            source: None,
        }
    }

    /// What the designer calls it.
    pub fn name(&self) -> &str {
        &self.document.design().name
    }

    /// Whether it was made of a picture.
    pub fn is_pictured(&self) -> bool {
        match self.document.design().structure() {
            Structure::Regions(regions) => regions.source().is_some(),
            _ => false,
        }
    }

    /// Whether it is figured cloth, which no shaft loom weaves: regions, or a drawdown that
    /// takes more shafts than looms have.
    pub fn is_figured(&self) -> bool {
        let drawdown = self.document.drawdown();
        match self.document.design().structure() {
            Structure::Draft(_) | Structure::Weave(_) => false,
            Structure::Regions(_) => true,
            Structure::Pattern(_) => {
                let crossings = u64::from(drawdown.ends()) * u64::from(drawdown.picks());
                crossings > LARGEST_DERIVED || shafts_needed(drawdown) > MOST_SHAFTS
            }
        }
    }

    /// The window's title: an asterisk says that something is not saved.
    pub fn title(&self) -> String {
        let mark = if self.document.is_modified() { "*" } else { "" };
        format!("{}{mark} — Pickglass", visible(self.name()))
    }

    /// A name of a file to propose, with this ending.
    pub fn file_name(&self, ending: &str) -> String {
        let letter = |letter: char| {
            if letter.is_control() || r#"/\:*?"<>|"#.contains(letter) {
                '-'
            } else {
                letter
            }
        };
        let name: String = self.name().trim().chars().map(letter).collect();
        let folder = self.path.as_deref().and_then(Path::parent);
        let file = format!("{name}.{ending}");
        folder.map_or(file.clone(), |folder| {
            folder.join(&file).display().to_string()
        })
    }

    /// The design as it is now.
    pub fn design(&self) -> Arc<Design> {
        Arc::clone(self.document.design())
    }
}

/// Whether a file is a design document, which holds all of a design.
fn own_format(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "ron")
}

/// A 2/2 twill on four shafts in two cottons: something to draw on.
pub fn blank() -> anyhow::Result<Opened> {
    let straight = Ties::from_rows((0..NEW_SIZE as u16).map(|thread| [thread % SHAFTS]));
    let tieup = Ties::from_rows((0..SHAFTS).map(|treadle| [treadle, (treadle + 1) % SHAFTS]));
    let lifting = Lifting::Treadled {
        tieup,
        treadling: straight.clone(),
    };
    let shafts = u32::from(SHAFTS);
    let draft = Draft::new(shafts, shafts, Shed::Rising, straight, lifting)?;
    let yarns = vec![
        Yarn::new("navy", Family::Cotton, Srgb(38, 52, 94)),
        Yarn::new("cream", Family::Cotton, Srgb(236, 226, 203)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = usual_sett(&yarns, &maps);
    let design = Design::new("untitled", Structure::Draft(draft), yarns, maps, sett)?;
    Ok(Opened {
        design: Arc::new(design),
        warnings: Vec::new(),
        path: None,
    })
}
