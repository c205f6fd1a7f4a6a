//! What the window remembers from one start to the next: layout, theme, recent files.
//!
//! The file is written whole or not at all, and a damaged one counts as none: it never
//! stops the start, and it is kept beside the new one for whoever wants to look.

use std::path::{Path, PathBuf};

use pickglass::atomic;
use ron::value::RawValue;
use serde::{Deserialize, Deserializer, Serialize};

use super::layout::KeptLayout;
use super::worker::Quality;
use crate::command_table::DraftLayout;

/// The most recent files that are remembered.
const MOST_RECENT: usize = 10;
/// A larger file is no settings file.
const LARGEST: u64 = 1 << 20;

/// What is remembered. Fields that an older file lacks have their usual value.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Light instead of dark.
    pub light: bool,
    #[serde(deserialize_with = "layout_if_known")]
    pub layout: Option<KeptLayout>,
    /// Newest first.
    pub recent: Vec<PathBuf>,
    pub arrangement: DraftLayout,
    pub grid_lines: bool,
    pub ghosts: bool,
    pub long_floats: bool,
    pub navigator: bool,
    /// Until when pictures are refined.
    pub quality: Quality,
    /// Millimetres a point of the screen, where a card was held against it.
    pub mm_per_point: Option<f32>,
    /// Newest first.
    pub references: Vec<KeptReference>,
}

/// A layout of panes that there are; one that names others is none, and all else stays.
fn layout_if_known<'de, D: Deserializer<'de>>(from: D) -> Result<Option<KeptLayout>, D::Error> {
    let text = Box::<RawValue>::deserialize(from)?;
    Ok(text.into_rust().unwrap_or_default())
}

/// By which picture a design is drawn: only its path is kept, beside that of the design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeptReference {
    pub design: PathBuf,
    pub image: PathBuf,
    pub opacity: f32,
    pub stretched: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            light: false,
            layout: None,
            recent: Vec::new(),
            arrangement: DraftLayout::default(),
            grid_lines: true,
            ghosts: true,
            long_floats: false,
            navigator: false,
            quality: Quality::default(),
            mm_per_point: None,
            references: Vec::new(),
        }
    }
}

impl Settings {
    /// Puts a file first among the recent ones.
    pub fn opened(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }

    /// The picture that the design in a file is drawn by.
    pub fn reference_of(&self, design: Option<&Path>) -> Option<&KeptReference> {
        let design = design?;
        (self.references.iter()).find(|kept| kept.design == design)
    }

    /// Remembers by which picture the design in a file is drawn, if by any.
    pub fn draws_by(&mut self, design: &Path, reference: Option<KeptReference>) {
        self.references.retain(|kept| kept.design != design);
        if let Some(reference) = reference {
            self.references.insert(0, reference);
            self.references.truncate(MOST_RECENT);
        }
    }
}

/// The file the settings are in; `None` = they are not kept.
#[derive(Debug, Clone, Default)]
pub struct SettingsFile(Option<PathBuf>);

impl SettingsFile {
    /// The user's own.
    pub fn of_user() -> Self {
        let folders = directories::ProjectDirs::from("", "", "pickglass");
        Self(folders.map(|folders| folders.config_dir().join("window.ron")))
    }

    /// The file at a path.
    #[cfg(test)]
    pub fn at(path: PathBuf) -> Self {
        Self(Some(path))
    }

    /// Reads the settings, and what was wrong with them if anything was.
    pub fn read(&self) -> (Settings, Option<String>) {
        let Some(path) = &self.0 else {
            return (Settings::default(), None);
        };
        if std::fs::metadata(path).is_ok_and(|about| about.len() > LARGEST) {
            return (
                Settings::default(),
                Some(self.set_aside(path, "it is too large")),
            );
        }
        let Ok(text) = std::fs::read(path) else {
            return (Settings::default(), None);
        };
        match ron::de::from_bytes(&text) {
            Ok(settings) => (settings, None),
            Err(error) => (
                Settings::default(),
                Some(self.set_aside(path, &error.code.to_string())),
            ),
        }
    }

    fn set_aside(&self, path: &Path, problem: &str) -> String {
        let kept = path.with_extension("ron.damaged");
        let kept = match std::fs::rename(path, &kept) {
            Ok(()) => format!("it was kept as {}", kept.display()),
            Err(_) => "it will be written over".to_owned(),
        };
        let problem: Vec<&str> = problem.split_whitespace().collect();
        let (file, problem) = (path.display(), problem.join(" "));
        format!("{file}: the settings are damaged ({problem}); the usual ones are used, {kept}")
    }

    /// Writes the settings.
    ///
    /// # Errors
    /// One line for the log: nothing of the work depends on it.
    pub fn write(&self, settings: &Settings) -> Result<(), String> {
        let Some(path) = &self.0 else {
            return Ok(());
        };
        let told = |error: &dyn std::fmt::Display| {
            format!("{}: the settings were not kept: {error}", path.display())
        };
        let text = ron::ser::to_string_pretty(settings, ron::ser::PrettyConfig::default())
            .map_err(|error| told(&error))?;
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(|error| told(&error))?;
        }
        atomic::write(path, text.as_bytes()).map_err(|error| told(&error))
    }
}

#[cfg(test)]
mod tests {
    use super::super::layout::Layout;
    use super::*;

    #[test]
    fn settings_come_back_and_damaged_ones_are_set_aside() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("deep").join("window.ron");
        let file = SettingsFile::at(path.clone());
        assert!(file.read().1.is_none());
        let mut settings = Settings {
            light: true,
            layout: Some(Layout::default().kept()),
            ..Settings::default()
        };
        for index in 0..12 {
            settings.opened(&PathBuf::from(format!("/{index}.ron")));
        }
        settings.opened(Path::new("/7.ron"));
        file.write(&settings).expect("written");
        let (read, wrong) = file.read();
        assert!(read.light && wrong.is_none());
        assert_eq!(read.recent.len(), MOST_RECENT);
        assert_eq!(
            read.recent[..2],
            [PathBuf::from("/7.ron"), PathBuf::from("/11.ron")]
        );

        // A layout with a pane that this program has not.
        let text = std::fs::read_to_string(&path).expect("read");
        std::fs::write(&path, text.replace("Pane(Log)", "Pane(Orchestra)")).expect("written");
        let (other, wrong) = file.read();
        assert!(read.layout.is_some() && other.layout.is_none() && wrong.is_none());
        assert!(other.light && other.recent == read.recent);

        std::fs::write(&path, "(light: maybe, recent: [").expect("written");
        let (read, wrong) = file.read();
        assert!(!read.light && read.recent.is_empty());
        assert!(wrong.is_some_and(|wrong| wrong.contains("damaged")));
        assert!(path.with_extension("ron.damaged").exists() && !path.exists());
    }

    #[test]
    fn an_older_file_without_some_settings_is_read() {
        let settings: Settings = ron::from_str("(light: true)").expect("read");
        assert!(settings.light && settings.grid_lines);
    }
}
