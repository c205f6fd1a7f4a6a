//! Hard cases: what once was, or would be, a wrong picture, a hang or a crash. Those that are
//! quick stand in the program itself (`pickglass selftest`), others beside the system that they
//! are of; [`list`] says where each is.

#[path = "../common/cloth_scenes/mod.rs"]
mod cloth_scenes;
#[path = "../common/named_tests/mod.rs"]
mod named_tests;

mod designs;
mod eyes_and_lights;
mod files;
mod furnace;
mod list;
mod noise;
mod pages;
mod random_designs;

use pickglass::job::Job;
use pickglass::selftest;

/// `short`, or `long` where `PICKGLASS_LONG` says that there is time.
fn how_many(short: u64, long: u64) -> u64 {
    match std::env::var_os("PICKGLASS_LONG") {
        Some(_) => long,
        None => short,
    }
}

#[test]
fn every_case_of_the_program_holds() {
    let verdicts = selftest::run(&[], &Job::new(), &mut |verdict| {
        println!(
            "{:28} {:.2} s {:?}",
            verdict.name, verdict.seconds, verdict.seen
        );
    });
    let failed: Vec<_> = (verdicts.expect("known cases").into_iter())
        .filter(|verdict| verdict.seen.is_err())
        .collect();
    assert!(failed.is_empty(), "{failed:#?}");
}
