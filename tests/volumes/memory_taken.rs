//! Writing takes memory for a box of voxels, whatever the window.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use crate::memory::{alone, peak, reset_peak};
use crate::volume_sources::Rule;
use glam::UVec3;
use pickglass::formats::volume;
use pickglass::job::Job;

#[test]
fn memory_does_not_grow_with_the_window() {
    let test = concat!(module_path!(), "::memory_does_not_grow_with_the_window");
    if alone(test, &[""]).is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for ending in ["vol", "vdb", "tif"] {
        let mut peaks = Vec::new();
        for size in [UVec3::new(256, 256, 64), UVec3::new(768, 384, 64)] {
            let path = folder.path().join(format!("cloth.{ending}"));
            let Some(before) = reset_peak() else {
                println!("not run: this system does not say how much memory is in use");
                return;
            };
            let written = volume::write(&Rule::new(size), &path, &[], &Job::new()).unwrap();
            let grown = peak().unwrap().saturating_sub(before);
            println!(
                "{ending}: {} bytes on disk, {grown} more in memory",
                written.bytes
            );
            peaks.push((written.bytes, grown));
        }
        let [(small, _), (large, grown)] = peaks[..] else {
            panic!("two sizes")
        };
        assert!(large > 4 * small);
        assert!(grown < 180 << 20, "{ending}: {grown} bytes for {large}");
        if ending == "vol" {
            // Holding the voxels or the files would have been seen.
            assert!(large > 2 * grown, "{ending}: {grown} bytes for {large}");
        }
    }
}
