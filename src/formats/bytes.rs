//! The bytes of a file, in bounds.

use std::io::Read;
use std::path::Path;

use super::error::FormatError;

/// The largest file that is opened: many times the largest design.
pub const MAX_FILE: u64 = crate::limits::FILE;

/// The bytes of a file, if they are no more than [`MAX_FILE`].
///
/// # Errors
/// [`FormatError`] for a file that cannot be read or is too large.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, FormatError> {
    let file = || path.display().to_string();
    let unreadable = |source| FormatError::Unreadable {
        file: file(),
        source,
    };
    let opened = std::fs::File::open(path).map_err(unreadable)?;
    let length = opened.metadata().map_or(0, |about| about.len());
    let mut bytes = Vec::with_capacity(length.min(MAX_FILE + 1) as usize);
    // One byte more than allowed tells a file that is too large, whatever its length says.
    opened
        .take(MAX_FILE + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > MAX_FILE {
        return Err(FormatError::TooLarge { file: file() });
    }
    Ok(bytes)
}
