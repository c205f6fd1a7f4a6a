//! Names in PDF pages: whatever a file calls a yarn is text there, and nothing else.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use pickglass::design::{
    Design, Family, Srgb, Structure, WeavePattern, Yarn, YarnId, YarnMaps, usual_sett,
};
use pickglass::print::{self, PdfOptions};

fn page(name: &str) -> Vec<u8> {
    let yarns = vec![
        Yarn::new(name, Family::Cotton, Srgb(20, 30, 90)),
        Yarn::new("weft", Family::Cotton, Srgb(240, 230, 200)),
    ];
    let maps = YarnMaps::plain(YarnId(0), YarnId(1));
    let sett = usual_sett(&yarns, &maps);
    let pattern = WeavePattern::from_fn(4, 4, |end, pick| (end + pick) % 2 == 0);
    let design = Design::new(name, Structure::Pattern(pattern), yarns, maps, sett).unwrap();
    let options = PdfOptions {
        cloth: false,
        draft: false,
        ..PdfOptions::default()
    };
    print::write(&design, &design.weave(), &options).unwrap()
}

fn find(bytes: &[u8], what: &[u8], from: usize) -> Option<usize> {
    let rest = bytes.get(from..)?;
    let at = rest.windows(what.len()).position(|window| window == what)?;
    Some(from + at)
}

/// The strings that the pages show, by a reader that shares nothing with the writer. A string
/// that does not end, or an operator that is none, is an error.
fn shown(file: &[u8]) -> Result<Vec<Vec<u8>>, String> {
    let mut strings = Vec::new();
    let mut from = 0;
    while let Some(start) = find(file, b"stream\n", from) {
        let start = start + b"stream\n".len();
        let end = find(file, b"\nendstream", start).ok_or("a stream without an end")?;
        from = end + b"\nendstream".len();
        let raw = &file[start..end];
        let content = miniz_oxide::inflate::decompress_to_vec_zlib(raw);
        let content = content.unwrap_or_else(|_| raw.to_vec());
        strings.extend(strings_of(&content)?);
    }
    Ok(strings)
}

fn strings_of(content: &[u8]) -> Result<Vec<Vec<u8>>, String> {
    let mut strings = Vec::new();
    let mut bytes = content.iter().copied().peekable();
    let mut word = String::new();
    while let Some(byte) = bytes.next() {
        match byte {
            b'(' => {
                let (mut depth, mut text) = (1, Vec::new());
                while depth > 0 {
                    match bytes.next().ok_or("a string without an end")? {
                        b'\\' => text.push(bytes.next().ok_or("an escape of nothing")?),
                        b'(' => {
                            depth += 1;
                            text.push(b'(');
                        }
                        b')' => {
                            depth -= 1;
                            text.push(b')');
                        }
                        other => text.push(other),
                    }
                }
                text.pop();
                strings.push(text);
            }
            b'<' => {
                let hex: Vec<u8> = bytes.by_ref().take_while(|byte| *byte != b'>').collect();
                let digit = |byte: u8| (byte as char).to_digit(16).ok_or("no hexadecimal digit");
                let pairs = hex.chunks(2).map(|pair| {
                    Ok((16 * digit(pair[0])? + digit(*pair.get(1).unwrap_or(&b'0'))?) as u8)
                });
                strings.push(pairs.collect::<Result<_, String>>()?);
            }
            b' ' | b'\n' => {
                known(&word)?;
                word.clear();
            }
            other => word.push(other as char),
        }
    }
    known(&word)?;
    Ok(strings)
}

/// Refuses what is no number, name or operator of the pages.
fn known(word: &str) -> Result<(), String> {
    const OPERATORS: &str = "BT ET Tf Td Tj Tm rg RG w re f S s m l h q Q cm Do g G n W";
    let is = word.is_empty()
        || word.parse::<f64>().is_ok()
        || word.starts_with('/')
        || OPERATORS.split(' ').any(|operator| operator == word);
    match is {
        true => Ok(()),
        false => Err(format!("no operator: {word:?}")),
    }
}

#[test]
fn hostile_names_are_text_and_nothing_else() {
    let plain = shown(&page("navy")).unwrap();
    assert!(plain.iter().any(|text| text == b"navy"), "{plain:?}");
    let long = "x".repeat(10_000);
    for name in [
        ") Tj ET Q (",
        "\\",
        "\\) Tj",
        "((((",
        "))))",
        "endstream endobj",
        "%PDF-1.7",
        "\u{202e}gnirts\u{0}\u{7}\u{1b}[2J",
        "綾 🧵 ﷽",
        "",
        long.as_str(),
    ] {
        let file = page(name);
        let strings = shown(&file).unwrap_or_else(|error| panic!("{name:?}: {error}"));
        // What is too long for a line takes more of them.
        let more = strings.len() - plain.len();
        assert!(more == 0 || name == long, "{name:?}");
        let controls = strings.iter().flatten().any(|byte| *byte < 32);
        assert!(!controls, "{name:?}");
        // The table of objects is where the end says.
        let end = find(&file, b"startxref\n", 0).unwrap() + b"startxref\n".len();
        let at = String::from_utf8_lossy(&file[end..]);
        let at: usize = at.lines().next().unwrap().parse().unwrap();
        assert!(file[at..].starts_with(b"xref"), "{name:?}");
    }
    let text = shown(&page(") Tj ET Q (")).unwrap();
    assert!(text.iter().any(|text| text == b") Tj ET Q ("), "{text:?}");
    // Control: a string that was put in as it is would be noticed.
    assert!(strings_of(b"BT () Tj ET Q () Tj ET").is_ok());
    assert!(strings_of(b"BT (\\) Tj ET").is_err());
    assert!(strings_of(b"BT (x) y) Tj ET").is_err());
}
