//! Draft and loom files, put together here field by field.

use std::path::Path;

use pickglass::formats::field_table::Field;
use pickglass::formats::{LoadOptions, load};

use super::{Outcome, Twins, Walker};

/// The walkers of all draft and loom formats.
pub fn walkers() -> Vec<Walker> {
    let walker = |format, twins, named| Walker {
        format,
        twins,
        read,
        named,
    };
    vec![
        walker("wif", wif as fn(&Path, &Field, &str) -> Twins, true),
        walker("dtx", dtx, true),
        walker("wpo", wpo, false),
        walker("dbw", dbw, true),
        walker("jc5", jc5, false),
    ]
}

/// All of a design that is cloth; what a file has beside it is kept word for word anyway.
fn read(path: &Path) -> Outcome {
    let imported = load(path, &LoadOptions::default()).map_err(|error| error.to_string())?;
    let design = &imported.design;
    let cloth = format!(
        "{}\n{:?}\n{:?}\n{:?}\n{:?}",
        design.weave(),
        design.structure(),
        design.yarns(),
        design.maps(),
        design.sett()
    );
    Ok((cloth, imported.warnings))
}

fn twins(folder: &Path, ending: &str, with: &[u8], without: &[u8]) -> Twins {
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(format!("{name}.{ending}"));
        std::fs::write(&path, bytes).expect("written");
        path
    };
    Twins {
        with: write("with", with),
        without: write("without", without),
    }
}

/// A draft of four ends and picks, every length of which is said.
const WIF: [(&str, &str); 11] = [
    ("WIF", "Version=1.1"),
    ("WEAVING", "Shafts=4\nTreadles=4\nRising Shed=true"),
    (
        "WARP",
        "Threads=4\nColor=1\nUnits=Centimeters\nSpacing=0.1\nThickness=0.05",
    ),
    (
        "WEFT",
        "Threads=4\nColor=2\nUnits=Centimeters\nSpacing=0.1\nThickness=0.05",
    ),
    ("COLOR PALETTE", "Range=0,255\nForm=RGB"),
    ("COLOR TABLE", "1=200,10,20\n2=10,30,90"),
    ("THREADING", "1=1\n2=2\n3=3\n4=4"),
    ("TIEUP", "1=1,2\n2=2,3\n3=3,4\n4=1,4"),
    ("TREADLING", "1=1\n2=2\n3=3\n4=4"),
    ("LIFTPLAN", ""),
    ("NOTES", "1=nothing"),
];

/// `[SECTION] Key`, whose value becomes the example, or `[SECTION]`, which gets it as a
/// line more.
fn wif(folder: &Path, field: &Field, written_name: &str) -> Twins {
    let mut base: Vec<(String, String)> = WIF
        .iter()
        .map(|(name, body)| ((*name).to_owned(), (*body).to_owned()))
        .collect();
    let body_of = |base: &mut Vec<(String, String)>, section: &str, body: &str| {
        for part in base.iter_mut().filter(|part| part.0 == section) {
            part.1 = body.to_owned();
        }
    };
    match field.name {
        // Weaves another cloth than the tie-up, which counts unless the loom says otherwise.
        "[WEAVING] Loom Type" => body_of(&mut base, "LIFTPLAN", "1=1\n2=2\n3=3\n4=4"),
        "[LIFTPLAN]" => {
            body_of(&mut base, "LIFTPLAN", "1=1\n2=2\n3=3\n4=4");
            base.retain(|part| !["TIEUP", "TREADLING"].contains(&part.0.as_str()));
        }
        _ => {}
    }
    let (section, key) = written_name[1..].split_once(']').expect("a section");
    let section = match written_name.starts_with('[') {
        true => section.to_owned(),
        false => format!("x{section}"),
    };
    let (_, own_key) = field.name.split_once(']').expect("a section");
    let own_section = &field.name[1..field.name.len() - own_key.len() - 1];
    let mut without = base.clone();
    if !own_key.is_empty() {
        let own_key = format!("{}=", own_key.trim());
        for part in without.iter_mut().filter(|part| part.0 == own_section) {
            let kept = part.1.lines().filter(|line| !line.starts_with(&own_key));
            part.1 = kept.collect::<Vec<_>>().join("\n");
        }
    }
    let line = match key.trim() {
        "" => field.example.to_owned(),
        key => format!("{key}={}", field.example),
    };
    let mut with = without.clone();
    match with.iter_mut().find(|part| part.0 == section) {
        Some(part) => part.1 = format!("{}\n{line}", part.1),
        None => with.push((section, line)),
    }
    let text = |parts: &[(String, String)]| {
        let mut text = String::new();
        for (name, body) in parts {
            text += &format!("[{name}]\n{body}\n");
        }
        text.into_bytes()
    };
    twins(folder, "wif", &text(&with), &text(&without))
}

/// Keys and sections of a Fiberworks draft.
const DTX: [(&str, &str); 9] = [
    ("@@StartDTX", ""),
    ("@@Info", "%%shafts 4\n%%treadles 4\n%%ends 4\n%%picks 4"),
    ("@@Threading", "1 2 3 4"),
    ("@@Tieup", "1000\n0100\n0010\n0001"),
    ("@@Treadling", "1 2 3 4"),
    ("@@Color Palet", "255,255,255\n200,30,40"),
    ("@@Warp Colors", "0 1 0 1"),
    ("@@Weft Colors", "1 1 0 1"),
    ("@@EndDTX", ""),
];

/// A section gets the example as its lines, a key as its value.
fn dtx(folder: &Path, field: &Field, written_name: &str) -> Twins {
    let mut base: Vec<(String, String)> = DTX
        .iter()
        .map(|(name, body)| ((*name).to_owned(), (*body).to_owned()))
        .collect();
    match field.name {
        "@@Liftplan" => {
            base.retain(|part| !["@@Tieup", "@@Treadling"].contains(&part.0.as_str()));
            let plan = "1000\n0100\n0010\n0001".to_owned();
            base.insert(3, ("@@Liftplan".to_owned(), plan));
        }
        "@@Color Palette" => base[5].0 = "@@Color Palette".to_owned(),
        // Without them there are usual colours.
        "@@Warp Colors" | "@@Weft Colors" => base.retain(|part| part.0 != field.name),
        _ => {}
    }
    let mut with = base.clone();
    if field.name.starts_with("%%") {
        let home = if field.name == "%%sinking" {
            "@@Tieup"
        } else {
            "@@Info"
        };
        let part = with
            .iter_mut()
            .find(|part| part.0 == home)
            .expect("it is there");
        let kept = part.1.lines().filter(|line| !line.starts_with(field.name));
        let rest = kept.collect::<Vec<_>>().join("\n");
        part.1 = format!("{written_name} {}\n{rest}", field.example);
    } else {
        let example = field.example.to_owned();
        match with.iter_mut().find(|part| part.0 == field.name) {
            Some(part) => *part = (written_name.to_owned(), example),
            None => with.insert(5, (written_name.to_owned(), example)),
        }
    }
    let text = |parts: &[(String, String)]| {
        let mut text = String::new();
        for (name, body) in parts {
            text += &format!("{name}\n{body}\n");
        }
        text.into_bytes()
    };
    twins(folder, "dtx", &text(&with), &text(&base))
}

/// A WeavePoint draft of three ends and picks.
struct Wpo {
    head: [u8; 24],
    threading: Vec<u8>,
    warp: Vec<u8>,
    weft: Vec<u8>,
    tieup: Vec<u8>,
    treadling: Vec<u8>,
    palette: Vec<u8>,
    behind: Vec<u8>,
}

impl Wpo {
    fn new() -> Self {
        let mut head = [0; 24];
        // Version 7, one treadle a pick, four shafts and treadles, a sheet of 3 × 3.
        (head[0], head[1], head[2], head[4], head[5]) = (123, 7, 101, 4, 4);
        (head[14], head[16]) = (3, 3);
        Self {
            head,
            threading: vec![1, 2, 3],
            warp: vec![0, 0, 1],
            weft: vec![1, 0, 0],
            tieup: vec![1, 2, 4, 8],
            treadling: vec![1, 2, 3],
            palette: vec![10, 20, 30, 40, 50, 60],
            behind: Vec::new(),
        }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = self.head.to_vec();
        let list = |bytes: &mut Vec<u8>, list: &[u8]| {
            bytes.extend((list.len() as u16).to_be_bytes());
            bytes.extend_from_slice(list);
        };
        for part in [&self.threading, &self.warp, &self.weft] {
            list(&mut bytes, part);
        }
        // A lift plan has no tie-up.
        if self.head[2] != 100 {
            bytes.extend_from_slice(&self.tieup);
        }
        list(&mut bytes, &self.treadling);
        bytes.extend_from_slice(&[0xff; 66]);
        bytes.push((self.palette.len() / 3) as u8);
        bytes.extend_from_slice(&self.palette);
        bytes.extend_from_slice(&self.behind);
        bytes
    }
}

fn wpo(folder: &Path, field: &Field, _: &str) -> Twins {
    let example: u8 = field.example.parse().expect("a byte");
    let mut with = Wpo::new();
    match field.name {
        "version" => with.head[1] = example,
        "kind of lifting" => with.head[2] = example,
        "shafts" => with.head[4] = example,
        "treadles" => {
            with.head[5] = example;
            with.tieup.push(1);
        }
        "rising shed" => with.head[7] = example,
        "ends per inch" => with.head[9] = example,
        "picks per inch" => with.head[10] = example,
        "sheet" => with.head[14] = example,
        "threading" => with.threading[0] = example,
        "warp colours" => with.warp[0] = example,
        "weft colours" => with.weft[1] = example,
        "tie-up" => with.tieup[0] = example,
        "treadling" => with.treadling[0] = example,
        "palette" => with.palette[0] = example,
        _ => with.behind.push(example),
    }
    twins(folder, "wpo", &with.bytes(), &Wpo::new().bytes())
}

/// A DB-WEAVE draft of four ends and three picks; every section is opened anew.
const DBW: [(&str, &str); 13] = [
    ("data/size/maxx2", "3"),
    ("data/size/maxy1", "3"),
    ("data/fields/einzug/data", "0100020003000100"),
    ("data/fields/aufknuepfung/data", "010000000100010001"),
    ("data/fields/aufknuepfung/sizex", "3"),
    ("data/fields/aufknuepfung/sizey", "3"),
    (
        "data/fields/trittfolge/trittfolge/data",
        "010000000100000100",
    ),
    ("data/fields/trittfolge/trittfolge/sizex", "3"),
    ("data/fields/trittfolge/trittfolge/sizey", "3"),
    ("data/fields/kettfarben/data", "00000001"),
    ("data/fields/schussfarben/data", "010001"),
    ("data/palette/data2", "ff00000000800000"),
    ("view/general/hebung", "1"),
];

fn dbw(folder: &Path, field: &Field, written_name: &str) -> Twins {
    let mut without: Vec<(&str, &str)> = DBW.to_vec();
    if field.name == "data/palette/data" {
        without.retain(|part| part.0 != "data/palette/data2");
    }
    // Without them there are usual colours.
    if ["kettfarben", "schussfarben", "palette"]
        .iter()
        .any(|name| field.name.contains(name))
    {
        without.retain(|part| part.0 != field.name);
    }
    let mut with = without.clone();
    match with.iter_mut().find(|part| part.0 == field.name) {
        Some(part) => *part = (written_name, field.example),
        None => with.push((written_name, field.example)),
    }
    let text = |parts: &[(&str, &str)]| {
        let mut text = "@dbw3:file\n".to_owned();
        for (path, value) in parts {
            let (sections, key) = path.rsplit_once('/').expect("a path");
            let depth = sections.split('/').count();
            for section in sections.split('/') {
                text += &format!("\\{section}{{\n");
            }
            text += &format!("{key}=={value}\n{}", "}\n".repeat(depth));
        }
        text.into_bytes()
    };
    twins(folder, "dbw", &text(&with), &text(&without))
}

/// A card file of one area of 8 hooks and two picks.
struct Card {
    records: Vec<(u32, u32)>,
    first: u32,
    hooks: u32,
    rows: Vec<u8>,
    behind: Vec<u8>,
}

impl Card {
    fn new() -> Self {
        Self {
            records: vec![(2, 2), (6, 0)],
            first: 1,
            hooks: 8,
            rows: vec![0x0f, 0xf0],
            behind: Vec::new(),
        }
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = b"\x81\xfe\x01\x01".to_vec();
        let mut numbers = vec![self.records.len() as u32];
        for &(tag, value) in &self.records {
            numbers.extend([tag, 4, value]);
        }
        numbers.extend([1, 0x64, 10, self.first, self.hooks]);
        bytes.extend(numbers.into_iter().flat_map(u32::to_be_bytes));
        bytes.extend_from_slice(b"A\0");
        bytes.extend_from_slice(&self.rows);
        bytes.extend_from_slice(&self.behind);
        bytes
    }
}

fn jc5(folder: &Path, field: &Field, _: &str) -> Twins {
    let number = || field.example.parse().expect("a number");
    let mut with = Card::new();
    match field.name {
        "picks" => {
            with.records[0].1 = number();
            with.rows.push(0x33);
        }
        "hooks" => {
            with.hooks = number();
            with.rows.extend([0x33, 0xcc]);
        }
        "rows" => with.rows[0] = u8::from_str_radix(field.example, 16).expect("a byte"),
        "record 6" => with.records[1].1 = number(),
        "record 9" => with.records.push((9, number())),
        "first number of area 1" => with.first = number(),
        _ => with.behind.push(0),
    }
    twins(folder, "jc5", &with.bytes(), &Card::new().bytes())
}
