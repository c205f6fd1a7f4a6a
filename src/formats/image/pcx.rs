//! PCX, decoded by the `pcx` crate: palettes and true colours.

use pcx::Reader;

use super::raster::fill_palette;
use super::{Fault, Pixels, Raster, check_coloured, check_declared};
use crate::design::Srgb;

/// Two bytes stand for at most 63 bytes of 8 pixels.
const MOST_PER_BYTE: u64 = 63 * 8 / 2;

/// Whether bytes begin as a PCX does: maker, version, encoding and bits a pixel.
pub(super) fn recognised(bytes: &[u8]) -> bool {
    bytes.len() >= 128
        && bytes[0] == 0x0a
        && matches!(bytes[1], 0 | 2..=5)
        && bytes[2] <= 1
        && matches!(bytes[3], 1 | 2 | 4 | 8)
}

pub(super) fn read(bytes: &[u8], warnings: &mut Vec<String>) -> Result<Raster, Fault> {
    let mut reader = Reader::from_mem(bytes).map_err(Fault::damaged)?;
    let (width, height) = reader.dimensions();
    let (width, height) = check_declared(width.into(), height.into(), bytes.len(), MOST_PER_BYTE)?;
    let (across, down) = (width as usize, height as usize);
    if !reader.is_paletted() {
        check_coloured((width, height))?;
        let mut colours = vec![[0u8; 3]; across * down];
        for row in colours.chunks_mut(across) {
            reader
                .next_row_rgb(row.as_flattened_mut())
                .map_err(Fault::damaged)?;
        }
        return Ok(Raster::new(
            width,
            height,
            Pixels::Colours(colours),
            Vec::new(),
        )?);
    }
    let mut table = [0u8; 256 * 3];
    let entries = reader.get_palette(&mut table).map_err(Fault::damaged)?;
    let mut palette: Vec<Srgb> = table
        .as_chunks::<3>()
        .0
        .iter()
        .take(entries)
        .map(|&[red, green, blue]| Srgb(red, green, blue))
        .collect();
    let mut indices = vec![0u8; across * down];
    for row in indices.chunks_mut(across) {
        reader.next_row_paletted(row).map_err(Fault::damaged)?;
    }
    let pixels = Pixels::Indices(indices);
    fill_palette(&mut palette, &pixels, warnings);
    Ok(Raster::new(width, height, pixels, palette)?)
}
