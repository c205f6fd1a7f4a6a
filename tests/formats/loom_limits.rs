//! Draft and loom files made to take memory or time: neither may grow far beyond file and
//! design.
//!
//! A process for each file, since peak memory is the process's.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use std::fmt::Write;

use crate::floods::read_flood;
use crate::memory::alone;

fn many(piece: &str) -> String {
    piece.repeat(6_000_000 / piece.len())
}

/// A Fiberworks draft of `ends` × `picks` with these lines behind it.
fn dtx(ends: u32, picks: u32, lines: &str) -> Vec<u8> {
    let info = format!("@@Info\n%%ends {ends}\n%%picks {picks}\n");
    format!("@@StartDTX\n{info}{lines}\n@@EndDTX\n").into_bytes()
}

const DTX: &str = "@@Threading\n1 2\n@@Liftplan\n10\n01\n";

fn dbw(fields: &str) -> Vec<u8> {
    format!("@dbw3:file\r\n\\data{{\r\n\\fields{{\r\n{fields}}}\r\n}}\r\n").into_bytes()
}

/// A DB-WEAVE lift plan on a grid of these sizes.
fn dbw_plan(ends: usize, shafts: usize, picks: usize) -> Vec<u8> {
    let threading = "0100".repeat(ends);
    let plan = "01".repeat(shafts * picks);
    let view = "\\view{\r\n\\general{\r\nviewpegplan==1\r\n}\r\n}\r\n";
    let mut text = String::from("@dbw3:file\r\n");
    let _ = write!(
        text,
        "\\data{{\r\n\\fields{{\r\n\\einzug{{\r\ndata=={threading}\r\n}}\r\n\\trittfolge{{\r\n\
         \\trittfolge{{\r\nsizex=={shafts}\r\nsizey=={picks}\r\ndata=={plan}\r\n}}\r\n}}\r\n\
         }}\r\n}}\r\n{view}"
    );
    text.into_bytes()
}

/// A card file with one area; `rows` bytes follow.
fn jc5(hooks: u32, picks: u32, rows: usize) -> Vec<u8> {
    let mut bytes = b"\x81\xfe\x01\x01".to_vec();
    for number in [1, 2, 4, picks, 1, 0x64, 9, 1, hooks] {
        bytes.extend_from_slice(&number.to_be_bytes());
    }
    bytes.push(0);
    bytes.extend((0..rows).map(|place| (place * 37 % 251) as u8));
    bytes
}

fn wpo(ends: u16, picks: u16) -> Vec<u8> {
    let mut bytes = vec![123, 7, 100, 7, 255, 255, 0, 0, 1, 5, 5, 1, 134];
    bytes.extend_from_slice(&ends.to_be_bytes());
    bytes.extend_from_slice(&picks.to_be_bytes());
    bytes.extend_from_slice(&[0; 7]);
    bytes.extend_from_slice(&ends.to_be_bytes());
    bytes.extend((0..ends).map(|end| (end % 255) as u8 + 1));
    bytes.extend_from_slice(&[0; 4]);
    bytes.extend_from_slice(&picks.to_be_bytes());
    bytes.extend(std::iter::repeat_n(0x7f, usize::from(picks) * 32));
    bytes.extend_from_slice(&[0; 67]);
    bytes
}

/// A file of a few megabytes, made when asked for, and whether it is a draft.
type Flood = (&'static str, fn() -> Vec<u8>, bool);

const FLOODS: [Flood; 21] = [
    ("dtx threads", || dtx(100_000, 2684, DTX), true),
    ("dtx too large", || dtx(100_000, 100_000, DTX), false),
    (
        "dtx one set",
        || {
            dtx(
                2,
                2,
                &format!("@@Threading\n{}\n@@Liftplan\n10", many("1,")),
            )
        },
        true,
    ),
    (
        "dtx sets",
        || {
            dtx(
                2,
                2,
                &format!("@@Threading\n{}\n@@Liftplan\n10", many("1 ")),
            )
        },
        true,
    ),
    (
        "dtx uncounted",
        || format!("@@StartDTX\n@@Liftplan\n1\n@@Threading\n{}", many("1 ")).into_bytes(),
        true,
    ),
    (
        "dtx blank lines",
        || dtx(2, 2, &format!("{DTX}@@Private\n{}", many("\n"))),
        true,
    ),
    (
        "dtx notes",
        || dtx(2, 2, &format!("{DTX}@@Notes\n{}", many("a\n"))),
        true,
    ),
    (
        "dtx colours",
        || dtx(2, 2, &format!("{DTX}@@Color Palet\n{}", many("1,2,3\n"))),
        false,
    ),
    ("dtx headers", || dtx(2, 2, &many("@@\n")), false),
    (
        "dtx tie-up",
        || {
            let ties = format!("{}\n", "1".repeat(60_000)).repeat(100);
            dtx(
                2,
                2,
                &format!("@@Threading\n1 2\n@@Tieup\n{ties}@@Treadling\n1 2"),
            )
        },
        true,
    ),
    (
        "dtx tie-up of one",
        || {
            let ties = format!("1\n{}\n", "0".repeat(60_000)).repeat(100);
            dtx(
                2,
                2,
                &format!("@@Threading\n1 2\n@@Tieup\n{ties}@@Treadling\n1 2"),
            )
        },
        true,
    ),
    ("dbw comments", || dbw(&many(";\r\n")), false),
    ("dbw sections", || dbw(&many("\\a{\r\n")), false),
    ("dbw fields", || dbw(&many("a==b\r\n")), false),
    (
        "dbw long names",
        || {
            let name = format!("\\{}{{\r\n", "x".repeat(2_000_000));
            dbw(&format!("{name}{}}}\r\n", "\\a{\r\n}\r\n".repeat(500_000)))
        },
        false,
    ),
    ("dbw threading", || dbw_plan(100_000, 1, 2000), true),
    ("dbw plan", || dbw_plan(20, 1000, 3000), true),
    ("jc5 cloth", || jc5(8000, 6000, 6_000_000), true),
    ("jc5 short", || jc5(1 << 14, 1 << 14, 1_000_000), false),
    ("jc5 large", || jc5(1 << 24, 1 << 24, 1000), false),
    ("wpo sheet", || wpo(4000, 60_000), true),
];

#[test]
fn floods_take_neither_memory_nor_time() {
    // A process for each, so that none profits from memory another has left behind.
    let names = FLOODS.map(|flood| flood.0);
    let test = concat!(module_path!(), "::floods_take_neither_memory_nor_time");
    if let Some(name) = alone(test, &names) {
        let (name, make, draft) = FLOODS.iter().find(|flood| flood.0 == name).unwrap();
        assert_eq!(read_flood(name, &make()), *draft, "{name}");
    }
}
