//! The weave library: weaves by family and name, embedded in the program.
//!
//! `presets/weaves/` holds one file a family. A weave is given as textbooks give it: by its
//! notation, as a draft (threading, tie-up, treadling), as threads of a twill or satin in
//! another order, or as weaves laid over each other; the repeat follows from that. Colour
//! and weave effects add the orders of dark and light threads.

use std::sync::LazyLock;

use serde::Deserialize;

use super::draft::{Draft, Lifting, Shed, Ties};
use super::pattern::WeavePattern;
use super::weaves::{
    both, counterchange, double_cloth, either, rearranged, regular_weave, shifted,
};

/// The files, one a family.
const FILES: [(&str, &str); 12] = [
    ("plain", include_str!("../../presets/weaves/plain.ron")),
    ("rib", include_str!("../../presets/weaves/rib.ron")),
    ("basket", include_str!("../../presets/weaves/basket.ron")),
    ("twill", include_str!("../../presets/weaves/twill.ron")),
    (
        "fancy twill",
        include_str!("../../presets/weaves/fancy-twill.ron"),
    ),
    ("satin", include_str!("../../presets/weaves/satin.ron")),
    ("crêpe", include_str!("../../presets/weaves/crepe.ron")),
    ("texture", include_str!("../../presets/weaves/texture.ron")),
    ("block", include_str!("../../presets/weaves/block.ron")),
    ("damask", include_str!("../../presets/weaves/damask.ron")),
    ("colour", include_str!("../../presets/weaves/colour.ron")),
    ("double", include_str!("../../presets/weaves/double.ron")),
];

/// A weave of the library.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LibraryWeave {
    name: String,
    also: Vec<String>,
    family: String,
    notation: String,
    usual_use: String,
    preview_only: bool,
    colours: Option<ColourOrders>,
    pattern: WeavePattern,
}

/// The orders of dark and light threads of a colour and weave effect: a number a thread,
/// 0 = dark, 1 = light, each with a period of its own.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ColourOrders {
    /// Of the ends, from the left.
    pub warp: Vec<u16>,
    /// Of the picks, from the bottom.
    pub weft: Vec<u16>,
}

impl LibraryWeave {
    /// Its name, which is a notation too.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Other names it goes by.
    pub fn also(&self) -> &[String] {
        &self.also
    }

    /// Its family.
    pub fn family(&self) -> &str {
        &self.family
    }

    /// How it is made, in a line.
    pub fn notation(&self) -> &str {
        &self.notation
    }

    /// Ends and picks of its repeat.
    pub fn repeat(&self) -> (u32, u32) {
        (self.pattern.ends(), self.pattern.picks())
    }

    /// What it is usually woven for.
    pub fn usual_use(&self) -> &str {
        &self.usual_use
    }

    /// One repeat.
    pub fn pattern(&self) -> &WeavePattern {
        &self.pattern
    }

    /// The orders of dark and light threads, where they make the effect.
    pub fn colours(&self) -> Option<&ColourOrders> {
        self.colours.as_ref()
    }

    /// A cloth of several layers, drawn here as a map of one: it can be looked at, but the
    /// program's cloth has a single layer.
    pub fn preview_only(&self) -> bool {
        self.preview_only
    }
}

/// A library file with something wrong; a test rules this out for the embedded ones.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("weave library, {place}: {problem}; correct the file in presets/weaves")]
pub struct LibraryError {
    /// The family, and the weave where it is known.
    pub place: String,
    /// What is wrong.
    pub problem: String,
}

#[derive(Deserialize)]
struct File {
    weaves: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    name: String,
    #[serde(default)]
    also: Vec<String>,
    of: Source,
    #[serde(rename = "use")]
    usual_use: String,
    #[serde(default)]
    preview_only: bool,
    #[serde(default)]
    colours: Option<(String, String)>,
}

/// A weave and how far it is laid to the right and up.
type Laid = (String, (i32, i32));

/// How a weave is given.
#[derive(Deserialize)]
enum Source {
    /// By notation.
    Notation(String),
    /// Line by line, the last line is pick 0.
    Drawn(Vec<String>),
    /// A draft on rising shafts, counted from 1.
    Draft {
        threading: String,
        tieup: String,
        treadling: String,
    },
    /// Threads of another weave in another order, counted from 1.
    Arranged {
        of: String,
        #[serde(default)]
        ends: String,
        #[serde(default)]
        picks: String,
    },
    /// Warp up where any of the weaves has it up.
    Either(Vec<Laid>),
    /// Warp up where all of the weaves have it up.
    Both(Vec<Laid>),
    /// A check of a weave and its reverse.
    Counterchange(String),
    /// Two cloths end and end, pick and pick.
    Double { face: String, back: String },
}

impl Source {
    fn weave(&self) -> Result<WeavePattern, String> {
        let notation = |text: &str| regular_weave(text).map_err(|error| error.to_string());
        let text = |error: &dyn std::error::Error| error.to_string();
        match self {
            Self::Notation(name) => notation(name),
            Self::Drawn(lines) => WeavePattern::parse(&lines.join("\n")).map_err(|e| text(&e)),
            Self::Draft {
                threading,
                tieup,
                treadling,
            } => {
                let (threading, tieup) = (Ties::parse(threading)?, Ties::parse(tieup)?);
                let treadling = Ties::parse(treadling)?;
                let (shafts, treadles) = (threading.bound(), tieup.len() as u32);
                let lifting = Lifting::Treadled { tieup, treadling };
                Draft::new(shafts, treadles, Shed::Rising, threading, lifting)
                    .map(|draft| draft.drawdown())
                    .map_err(|e| text(&e))
            }
            Self::Arranged { of, ends, picks } => {
                rearranged(&notation(of)?, &numbers(ends)?, &numbers(picks)?).map_err(|e| text(&e))
            }
            Self::Either(laid) => join(laid, either),
            Self::Both(laid) => join(laid, both),
            Self::Counterchange(of) => counterchange(&notation(of)?).map_err(|e| text(&e)),
            Self::Double { face, back } => {
                double_cloth(&notation(face)?, &notation(back)?).map_err(|e| text(&e))
            }
        }
    }

    /// How the weave is made, in a line.
    fn in_words(&self) -> String {
        let laid = |list: &[Laid], word: &str| {
            let parts: Vec<String> = list
                .iter()
                .map(|(weave, (right, up))| match (right, up) {
                    (0, 0) => weave.clone(),
                    _ => format!("{weave} laid {right} right and {up} up"),
                })
                .collect();
            parts.join(word)
        };
        match self {
            Self::Notation(name) => name.clone(),
            Self::Drawn(_) => "drawn".to_owned(),
            Self::Draft {
                threading,
                tieup,
                treadling,
            } => format!("threading {threading}; tie-up {tieup}; treadling {treadling}"),
            Self::Arranged { of, ends, picks } => {
                let order = |what: &str, order: &str| match order {
                    "" => String::new(),
                    order => format!(", {what} in order {order}"),
                };
                format!("{of}{}{}", order("ends", ends), order("picks", picks))
            }
            Self::Either(list) => laid(list, " or "),
            Self::Both(list) => laid(list, " and "),
            Self::Counterchange(of) => format!("{of} and its reverse in a check"),
            Self::Double { face, back } => {
                format!("{face} over {back}, end and end, pick and pick")
            }
        }
    }
}

type Join = fn(&WeavePattern, &WeavePattern) -> Result<WeavePattern, super::CombineError>;

fn join(laid: &[Laid], join: Join) -> Result<WeavePattern, String> {
    let mut whole: Option<WeavePattern> = None;
    for (name, (right, up)) in laid {
        let weave = regular_weave(name).map_err(|error| error.to_string())?;
        let weave = shifted(&weave, *right, *up);
        whole = Some(match whole {
            None => weave,
            Some(whole) => join(&whole, &weave).map_err(|error| error.to_string())?,
        });
    }
    whole.ok_or_else(|| "no weaves to join: name one at least".to_owned())
}

fn numbers(text: &str) -> Result<Vec<u32>, String> {
    let number = |word: &str| word.parse().map_err(|_| format!("\"{word}\" is no number"));
    text.split_whitespace().map(number).collect()
}

/// Dark and light threads from `D4 L4 D L`: a letter and how many.
fn threads(text: &str) -> Result<Vec<u16>, String> {
    let mut order = Vec::new();
    for word in text.split_whitespace() {
        let colour = match word.chars().next() {
            Some('D') => 0,
            Some('L') => 1,
            _ => return Err(format!("\"{word}\" is neither dark (D4) nor light (L4)")),
        };
        let count = match &word[1..] {
            "" => 1,
            digits => digits
                .parse::<usize>()
                .ok()
                .filter(|count| (1..=1024).contains(count))
                .ok_or_else(|| format!("\"{word}\" has no number of threads"))?,
        };
        order.extend(std::iter::repeat_n(colour, count));
    }
    match order.is_empty() {
        true => Err("an order without threads".to_owned()),
        false => Ok(order),
    }
}

/// Reads every embedded file.
///
/// # Errors
/// [`LibraryError`] with the family, the weave and what is wrong.
pub fn read_library() -> Result<Vec<LibraryWeave>, LibraryError> {
    let mut all = Vec::new();
    for (family, text) in FILES {
        let wrong = |place: String, problem: String| LibraryError { place, problem };
        let file: File =
            ron::from_str(text).map_err(|error| wrong(family.to_owned(), error.to_string()))?;
        for entry in file.weaves {
            let named = |problem| wrong(format!("{family}, {}", entry.name), problem);
            let colours = match &entry.colours {
                None => None,
                Some((warp, weft)) => Some(ColourOrders {
                    warp: threads(warp).map_err(named)?,
                    weft: threads(weft).map_err(named)?,
                }),
            };
            all.push(LibraryWeave {
                pattern: entry.of.weave().map_err(named)?,
                notation: entry.of.in_words(),
                name: entry.name,
                also: entry.also,
                family: family.to_owned(),
                usual_use: entry.usual_use,
                preview_only: entry.preview_only,
                colours,
            });
        }
    }
    Ok(all)
}

/// Every weave of the library, by family.
pub fn library() -> &'static [LibraryWeave] {
    static LIBRARY: LazyLock<Vec<LibraryWeave>> = LazyLock::new(|| {
        read_library().unwrap_or_else(|error| {
            log::error!("{error}");
            Vec::new()
        })
    });
    &LIBRARY
}

/// The weave of a name, in any case and with or without accents; `None` if there is none.
pub fn find(name: &str) -> Option<&'static LibraryWeave> {
    let wanted = plain_letters(name);
    library().iter().find(|weave| {
        let mut names = std::iter::once(&weave.name).chain(&weave.also);
        names.any(|name| plain_letters(name) == wanted)
    })
}

/// A name without case, accents, typographic quotes and doubled blanks.
fn plain_letters(name: &str) -> String {
    let words: Vec<&str> = name.split_whitespace().collect();
    let joined = words.join(" ").to_lowercase();
    joined
        .chars()
        .map(|letter| match letter {
            'ê' | 'è' | 'é' => 'e',
            'ï' => 'i',
            '’' | '‘' => '\'',
            other => other,
        })
        .collect()
}
