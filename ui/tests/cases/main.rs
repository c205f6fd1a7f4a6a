//! Files and commands that once failed: each gives what the README beside it wants.
//!
//!     cargo test --release --workspace case_
//!
//! prints the table of all of them, those of the window included.

mod program;

mod case_01;
mod case_02;
mod case_03;
mod case_04;
mod case_05;
mod case_06;
mod case_07;
mod case_08;
mod case_09;
mod case_10;
mod case_10_texts;
mod case_11;
mod case_12;
mod case_13;
mod case_14;
mod case_15;
mod case_16;
mod case_17;
mod case_18;
mod case_19;
mod case_20;
mod case_20_files;
mod case_20_limits;
mod case_21;
mod volumes;
