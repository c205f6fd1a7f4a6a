//! GIF: the first frame, with its own or the common palette.

use std::num::NonZeroU64;

use gif::{ColorOutput, DecodeOptions, MemoryLimit};

use super::raster::fill_palette;
use super::{Fault, Pixels, Raster, TRANSPARENT, check_declared, remark};
use crate::design::{MAX_CROSSINGS, Srgb};

/// LZW names at most 4096 pixels with a code of 12 bits.
const MOST_PER_BYTE: u64 = 4096;

pub(super) fn read(bytes: &[u8], warnings: &mut Vec<String>) -> Result<Raster, Fault> {
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::Indexed);
    // The frame is read into a buffer of our own; this only stops what is absurd.
    if let Some(most) = NonZeroU64::new(MAX_CROSSINGS) {
        options.set_memory_limit(MemoryLimit::Bytes(most));
    }
    let mut decoder = options.read_info(bytes).map_err(Fault::damaged)?;
    let (width, height) = check_declared(
        decoder.width().into(),
        decoder.height().into(),
        bytes.len(),
        MOST_PER_BYTE,
    )?;
    let frame = decoder
        .next_frame_info()
        .map_err(Fault::damaged)?
        .ok_or_else(|| Fault::damaged("it has no frame"))?;
    let (left, top) = (usize::from(frame.left), usize::from(frame.top));
    let (across, down) = (usize::from(frame.width), usize::from(frame.height));
    let clear = frame.transparent;
    let inside = left + across <= width as usize && top + down <= height as usize;
    if across == 0 || down == 0 || !inside {
        return Err(Fault::damaged("its frame lies outside it"));
    }
    check_declared(across as u64, down as u64, bytes.len(), MOST_PER_BYTE)?;
    let mut palette: Vec<Srgb> = decoder
        .palette()
        .map_err(Fault::damaged)?
        .as_chunks::<3>()
        .0
        .iter()
        .map(|&[red, green, blue]| Srgb(red, green, blue))
        .collect();
    let background = decoder.bg_color().unwrap_or(0);
    let mut indices = vec![0u8; across * down];
    decoder
        .read_into_buffer(&mut indices)
        .map_err(Fault::damaged)?;
    let whole = (left, top) == (0, 0) && (across, down) == (width as usize, height as usize);
    if !whole {
        let usual = clear.unwrap_or(background.min(255) as u8);
        let mut canvas = vec![usual; width as usize * height as usize];
        for (row, line) in indices.chunks(across).enumerate() {
            let from = (top + row) * width as usize + left;
            canvas[from..from + across].copy_from_slice(line);
        }
        indices = canvas;
    }
    if let Ok(Some(_)) = decoder.next_frame_info() {
        remark(warnings, "only the first picture of the animation is read");
    }
    let pixels = Pixels::Indices(indices);
    if let (Some(clear), Pixels::Indices(indices)) = (clear, &pixels)
        && indices.contains(&clear)
    {
        remark(warnings, TRANSPARENT);
        if let Some(colour) = palette.get_mut(usize::from(clear)) {
            *colour = Srgb(255, 255, 255);
        }
    }
    fill_palette(&mut palette, &pixels, warnings);
    Ok(Raster::new(width, height, pixels, palette)?)
}
