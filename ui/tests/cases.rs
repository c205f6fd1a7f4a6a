//! Files and commands that once failed: each gives what the README beside it wants.
//!
//!     cargo test --release --workspace case_
//!
//! prints the table of all of them, those of the window included.

#[path = "cases/program.rs"]
mod program;

#[path = "cases/case_01.rs"]
mod case_01;
#[path = "cases/case_02.rs"]
mod case_02;
#[path = "cases/case_03.rs"]
mod case_03;
#[path = "cases/case_04.rs"]
mod case_04;
#[path = "cases/case_05.rs"]
mod case_05;
#[path = "cases/case_06.rs"]
mod case_06;
#[path = "cases/case_07.rs"]
mod case_07;
#[path = "cases/case_08.rs"]
mod case_08;
#[path = "cases/case_09.rs"]
mod case_09;
#[path = "cases/case_10.rs"]
mod case_10;
#[path = "cases/case_10_texts.rs"]
mod case_10_texts;
#[path = "cases/case_11.rs"]
mod case_11;
#[path = "cases/case_12.rs"]
mod case_12;
#[path = "cases/case_13.rs"]
mod case_13;
#[path = "cases/case_14.rs"]
mod case_14;
#[path = "cases/case_15.rs"]
mod case_15;
#[path = "cases/case_16.rs"]
mod case_16;
#[path = "cases/case_17.rs"]
mod case_17;
#[path = "cases/case_18.rs"]
mod case_18;
#[path = "cases/case_19.rs"]
mod case_19;
#[path = "cases/case_20.rs"]
mod case_20;
#[path = "cases/case_20_files.rs"]
mod case_20_files;
#[path = "cases/case_20_limits.rs"]
mod case_20_limits;
#[path = "cases/case_21.rs"]
mod case_21;
#[path = "cases/volumes.rs"]
mod volumes;
