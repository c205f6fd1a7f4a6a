//! A TIFF of 16-bit pages, one a layer from back to face, uncompressed and one behind the
//! other, so that programs that only look at the first page can still find the rest.
//! Beyond 4 GB it is a BigTIFF. Libraries write pages in order; here boxes of voxels
//! arrive that cross all pages, so head and directories are made here.
//!
//! Rows are stored from pick 0 upwards, which the orientation tag says.

use std::path::Path;

use super::dense::{Channel, Layer};
use super::{VolumeFileError, beside};
use crate::memory;
use crate::volume::source::Frame;

/// Most pages: each needs a directory.
const MOST_PAGES: u32 = 1 << 20;
/// Largest TIFF with 32-bit offsets, with room for the directories.
const LARGEST_CLASSIC: u64 = 0xF000_0000;

/// Most bytes of a page's directory.
const DIRECTORY: u64 = 300;

const SHORT: u16 = 3;
const LONG: u16 = 4;
const RATIONAL: u16 = 5;
const ASCII: u16 = 2;
const LONG8: u16 = 16;

/// The two files of a volume; `densest` is the extinction that 65535 stands for.
pub(super) fn layers(
    frame: &Frame,
    densest: f32,
    path: &Path,
) -> Result<Vec<Layer>, VolumeFileError> {
    let too_large = |what: String| VolumeFileError::TooLarge {
        path: path.to_owned(),
        what,
    };
    if frame.size.z > MOST_PAGES {
        return Err(too_large(format!("a TIFF of {} pages", frame.size.z)));
    }
    let page = u64::from(frame.size.x) * u64::from(frame.size.y) * 2;
    if page >= LARGEST_CLASSIC {
        return Err(too_large(format!("a TIFF page of {page} bytes")));
    }
    // A directory a page stands behind the voxels, in either file.
    let directories = u64::from(frame.size.z) * DIRECTORY;
    memory::ask(2 * directories, || path.display().to_string())?;
    let unit = densest.max(f32::MIN_POSITIVE) / 65535.0;
    let layer = |path, channel, about: &str| {
        let (head, tail) = around(frame, about);
        Layer {
            path,
            channel,
            head,
            tail,
            header: None,
        }
    };
    let about = format!("extinction_per_step={unit} 1/mm\n");
    Ok(vec![
        layer(path.to_owned(), Channel::Sigma16(unit), &about),
        layer(
            beside(path, "yarn"),
            Channel::Yarn16,
            "yarn number + 1; 0 = none\n",
        ),
    ])
}

/// What stands before and behind the voxels.
fn around(frame: &Frame, about: &str) -> (Vec<u8>, Vec<u8>) {
    let [nx, ny, nz] = frame.size.to_array();
    let page = u64::from(nx) * u64::from(ny) * 2;
    let big = page.saturating_mul(u64::from(nz)) >= LARGEST_CLASSIC;
    let head_bytes = if big { 16 } else { 8 };
    let mut description = format!(
        "ImageJ=1.53k\nimages={nz}\nslices={nz}\nunit=mm\nspacing={}\nloop=false\n{about}",
        frame.edge_mm
    )
    .into_bytes();
    description.push(0);
    description.resize(description.len().next_multiple_of(8), 0);

    let behind = head_bytes + page * u64::from(nz);
    // Words stand on even places.
    let pad = behind % 2;
    let mut writer = Directories {
        big,
        at: behind + pad,
        bytes: vec![0; pad as usize],
    };
    let described = writer.put(&description);
    // Pixels a cm, as a fraction.
    let mut resolution = ((10.0 / frame.edge_mm * 1000.0).round().clamp(1.0, 4e9) as u32)
        .to_le_bytes()
        .to_vec();
    resolution.extend(1000u32.to_le_bytes());
    let inline = u64::from_le_bytes(resolution.clone().try_into().unwrap_or_default());
    let resolved = writer.put(&resolution);
    let resolution = if big { inline } else { resolved };

    let first = writer.at;
    for number in 0..nz {
        let mut entries = vec![
            (256, LONG, 1, u64::from(nx)),
            (257, LONG, 1, u64::from(ny)),
            (258, SHORT, 1, 16),
            (259, SHORT, 1, 1),
            (262, SHORT, 1, 1),
        ];
        if number == 0 {
            entries.push((270, ASCII, description.len() as u64, described));
        }
        entries.extend([
            (
                273,
                if big { LONG8 } else { LONG },
                1,
                head_bytes + page * u64::from(number),
            ),
            (274, SHORT, 1, 4),
            (277, SHORT, 1, 1),
            (278, LONG, 1, u64::from(ny)),
            (279, LONG, 1, page),
            (282, RATIONAL, 1, resolution),
            (283, RATIONAL, 1, resolution),
            (296, SHORT, 1, 3),
        ]);
        writer.directory(&entries, number + 1 == nz);
    }
    let mut head = b"II".to_vec();
    if big {
        head.extend([43, 0, 8, 0, 0, 0]);
        head.extend(first.to_le_bytes());
    } else {
        head.extend([42, 0]);
        head.extend((first as u32).to_le_bytes());
    }
    (head, writer.bytes)
}

/// What follows the voxels.
struct Directories {
    big: bool,
    /// Where the next byte will stand.
    at: u64,
    bytes: Vec<u8>,
}

impl Directories {
    /// Puts bytes and says where they stand.
    fn put(&mut self, bytes: &[u8]) -> u64 {
        let at = self.at;
        self.bytes.extend(bytes);
        self.at += bytes.len() as u64;
        at
    }

    /// A number of the width of offsets.
    fn wide(&self, number: u64) -> Vec<u8> {
        if self.big {
            number.to_le_bytes().to_vec()
        } else {
            (number as u32).to_le_bytes().to_vec()
        }
    }

    fn directory(&mut self, entries: &[(u16, u16, u64, u64)], last: bool) {
        let mut bytes = if self.big {
            (entries.len() as u64).to_le_bytes().to_vec()
        } else {
            (entries.len() as u16).to_le_bytes().to_vec()
        };
        for &(tag, kind, count, value) in entries {
            bytes.extend(tag.to_le_bytes());
            bytes.extend(kind.to_le_bytes());
            bytes.extend(self.wide(count));
            bytes.extend(self.wide(value));
        }
        let width = if self.big { 8 } else { 4 };
        let next = if last {
            0
        } else {
            self.at + bytes.len() as u64 + width
        };
        bytes.extend(self.wide(next));
        self.put(&bytes);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;
    use glam::{DVec3, UVec3};
    use std::io::{Seek, SeekFrom, Write};
    use tiff::decoder::{Decoder, Limits};

    /// Pages and their sizes as another reader finds them, over a hole for the voxels.
    fn pages(size: UVec3) -> Vec<(u32, u32)> {
        let frame = Frame {
            size,
            origin_mm: DVec3::ZERO,
            edge_mm: 0.01,
        };
        let (head, tail) = around(&frame, "about\n");
        let mut file = tempfile::tempfile().unwrap();
        file.write_all(&head).unwrap();
        let voxels = frame.voxels() * 2;
        file.seek(SeekFrom::Start(head.len() as u64 + voxels))
            .unwrap();
        file.write_all(&tail).unwrap();
        file.seek(SeekFrom::Start(0)).unwrap();
        let mut decoder = Decoder::new(file).unwrap().with_limits(Limits::unlimited());
        let mut found = vec![decoder.dimensions().unwrap()];
        while decoder.more_images() {
            decoder.next_image().unwrap();
            found.push(decoder.dimensions().unwrap());
        }
        found
    }

    #[test]
    fn stacks_beyond_four_gigabytes_are_big() {
        for size in [UVec3::new(5, 3, 2), UVec3::new(8192, 8192, 40)] {
            let big = around(
                &Frame {
                    size,
                    origin_mm: DVec3::ZERO,
                    edge_mm: 1.0,
                },
                "",
            )
            .0
            .len()
                == 16;
            assert_eq!(big, size.z == 40);
            let expected = vec![(size.x, size.y); size.z as usize];
            assert_eq!(pages(size), expected);
        }
    }
}
