//! The inputs of tests/cases/19, each with what is wanted of it, and their neighbours.

use crate::program::Place;

#[test]
fn case_19_a_profile_that_unpacks_without_end_is_ignored_and_told() {
    let place = Place::of("19");
    for arguments in [
        &["posterize", "iccp.png", "-o", "o.ron", "--colours", "2"][..],
        &["convert", "iccp.png", "o.png", "--as", "artwork"][..],
    ] {
        let mut command = place.command(arguments);
        command.env("PICKGLASS_MEMORY", "64M");
        let said = crate::program::Said::of(command.output().expect("starts")).done();
        assert!(said.err.contains("iCCP"), "{}", said.err);
        assert!(said.err.contains("ignored"), "{}", said.err);
    }
}
