//! Damaged, cut and random draft and loom files: an answer or an error, never a panic,
//! never for long.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::path::Path;
use std::time::{Duration, Instant};

use pickglass::formats::{LoadOptions, Place, SheetError, dbw, dtx, jc5, load_bytes, wpo};
use pickglass::selftest::damaged;
use proptest::prelude::*;

fn fixtures() -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/looms");
    let mut found: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|ending| ending != "gif"))
        .map(|path| {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, std::fs::read(&path).unwrap())
        })
        .collect();
    found.sort();
    assert_eq!(found.len(), 9);
    found
}

/// Reads bytes as whatever they are; a design must be whole, an error one line.
fn survives(bytes: &[u8]) -> bool {
    let started = Instant::now();
    let options = LoadOptions {
        face_down: bytes.len() % 2 == 1,
        ..LoadOptions::default()
    };
    let answer = load_bytes(bytes, "fuzz", &options);
    assert!(started.elapsed() < Duration::from_secs(5));
    match answer {
        Ok(imported) => {
            let design = imported.design;
            assert_eq!(design.sett().fault(), None);
            if u64::from(design.ends()) * u64::from(design.picks()) < 1 << 20 {
                let weave = design.weave();
                let size = (design.ends(), design.picks());
                assert_eq!((weave.ends(), weave.picks()), size);
            }
            true
        }
        Err(error) => {
            let message = error.to_string();
            assert_eq!(message.lines().count(), 1, "{message:?}");
            assert!(message.starts_with("fuzz"), "{message:?}");
            false
        }
    }
}

#[test]
fn files_cut_at_every_length_give_an_answer() {
    for (name, bytes) in fixtures() {
        let cuts = (0..bytes.len()).filter(|&end| survives(&bytes[..end]));
        let read = cuts.count();
        println!("{name}: {read} of {} cuts are read", bytes.len());
        assert!(survives(&bytes), "{name}");
        match name.rsplit_once('.').unwrap().1 {
            // What follows the treadling and the colours may be missing, and is warned about.
            "dtx" => assert!(read < bytes.len() / 2),
            // Brackets tell, except between two sections.
            "dbw" => assert!(read <= 5, "{read}"),
            "wpo" => assert_eq!(read, 0),
            _ => assert_eq!(read, if name == "odd.jc5" { 6 } else { 0 }),
        }
    }
}

#[test]
fn cut_files_say_where() {
    for (name, bytes) in fixtures() {
        let read = |bytes: &[u8]| -> Result<(), SheetError> {
            let options = LoadOptions::default();
            match name.rsplit_once('.').unwrap().1 {
                "wpo" => wpo::read(bytes, "x", &options).map(drop),
                "jc5" => jc5::read(bytes, "x", &options).map(drop),
                "dbw" => dbw::read(bytes, "x", &options).map(drop),
                _ => dtx::read(bytes, "x", &options).map(drop),
            }
        };
        assert!(read(&bytes).is_ok());
        if let Err(error) = read(&bytes[..bytes.len() / 2]) {
            let placed = matches!(error.place, Some(Place::Byte(byte)) if byte <= bytes.len());
            let binary = name.ends_with("wpo") || name.ends_with("jc5");
            assert_eq!(placed, binary, "{error}");
        }
    }
}

/// What is put in at random places.
const PIECES: [&[u8]; 12] = [
    b"@@",
    b"%%",
    b"\r\n",
    b"{",
    b"}",
    b"==",
    b"\\",
    b"\xff\xff\xff\xff",
    b"\0\0",
    b"99999999999",
    b",",
    b"-1",
];
#[test]
fn mutated_files_give_an_answer() {
    let sources = fixtures();
    let (mut read, rounds) = (0, 1500);
    for (index, (_, source)) in sources.iter().enumerate() {
        for round in 0..rounds {
            read += usize::from(survives(&damaged(
                source,
                (index as u64) << 32 | round,
                &PIECES,
            )));
        }
    }
    let all = sources.len() * rounds as usize;
    assert!(read > all / 20 && read < all * 9 / 10, "{read} of {all}");
}

proptest! {
    #[test]
    fn random_bytes_behind_every_beginning_give_an_answer(
        bytes in proptest::collection::vec(any::<u8>(), 0..400),
        kind in 100u8..103,
        small in proptest::collection::vec(0u8..4, 0..200),
    ) {
        let beginnings: [&[u8]; 4] = [
            b"@@StartDTX\n@@Threading\n1 2\n@@Liftplan\n",
            b"@dbw3:file\r\n\\data{\r\n\\fields{\r\n\\einzug{\r\ndata==0100",
            b"\x81\xfe\x01\x01",
            &[123, 7, kind, 0, 3, 3, 0, 0, 0, 5, 5, 0, 0, 0, 3, 0, 3, 0, 0, 0, 0, 0, 0, 0],
        ];
        for beginning in beginnings {
            for rest in [&bytes, &small] {
                survives(&[beginning, rest].concat());
            }
        }
    }

    #[test]
    fn random_sections_give_an_answer(text in "(@@(Threading|Tieup|Treadling|Liftplan|Color Palet|Warp Colors|Weft Spacing|Info|Notes)\n|[0-9 ,]{1,12}\n|[01]{1,9}\n|%%(ends|picks|shafts|sinking) ?[0-9]{0,7}\n){0,60}") {
        survives(format!("@@StartDTX\n{text}").as_bytes());
    }

    #[test]
    fn random_fields_give_an_answer(text in "(\\\\(data|fields|einzug|trittfolge|aufknuepfung|size|palette|view|general)\\{\r\n|\\}\r\n|(data|data2|sizex|sizey|maxx1|hebung|viewpegplan)==[0-9a-f]{0,12}(\\\\)?\r\n|[0-9a-f]{2,8}\r\n){0,60}") {
        survives(format!("@dbw3:file\r\n{text}").as_bytes());
    }
}
