//! Block means: what the statistics over passes are made of.

use crate::ReportError;
use crate::view::{ImageView, mean};
use serde::Serialize;

/// One tile of an image, with the means of two images over it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Block {
    /// Its left column.
    pub x: usize,
    /// Its top row.
    pub y: usize,
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Pixels that are finite in both images: the means are over these, and NaN (null in JSON) if there are none.
    pub compared: usize,
    /// Mean of the image.
    pub image: [f64; 3],
    /// Mean of the reference.
    pub reference: [f64; 3],
}

/// Mean of each of `columns` x `rows` blocks, row by row. Sizes differ by a pixel where they do not divide the image.
/// Nothing is left out: a block with a pixel that is not finite has a mean that is not.
pub fn block_means(image: &ImageView, columns: usize, rows: usize) -> Result<Vec<[f64; 3]>, ReportError> {
    Ok(tiles(image, columns, rows)?.map(|tile| mean(tile.indices(image).map(|i| image.pixels()[i]))).collect())
}

/// Blocks of both, without the pixels that are not `finite`.
pub(crate) fn compare_blocks(
    image: &ImageView,
    reference: &ImageView,
    [columns, rows]: [usize; 2],
    finite: impl Fn(usize) -> bool,
) -> Result<Vec<Block>, ReportError> {
    let block = |tile: Tile| {
        let kept: Vec<usize> = tile.indices(image).filter(|i| finite(*i)).collect();
        let mean_of = |view: &ImageView| mean(kept.iter().map(|i| view.pixels()[*i]));
        let Tile { x, y, width, height } = tile;
        Block { x, y, width, height, compared: kept.len(), image: mean_of(image), reference: mean_of(reference) }
    };
    Ok(tiles(image, columns, rows)?.map(block).collect())
}

struct Tile {
    x: usize,
    y: usize,
    width: usize,
    height: usize,
}

impl Tile {
    fn indices(&self, image: &ImageView) -> impl Iterator<Item = usize> {
        let (across, stride) = (self.x..self.x + self.width, image.width());
        (self.y..self.y + self.height).flat_map(move |y| across.clone().map(move |x| y * stride + x))
    }
}

fn tiles(image: &ImageView, columns: usize, rows: usize) -> Result<impl Iterator<Item = Tile>, ReportError> {
    let (width, height) = (image.width(), image.height());
    if columns == 0 || rows == 0 || columns > width || rows > height {
        return Err(ReportError::Tiling { width, height, columns, rows });
    }
    // 128 bits: the product of two sizes may exceed 64.
    let edge = |i: usize, of: usize, size: usize| (i as u128 * size as u128 / of as u128) as usize;
    Ok((0..rows).flat_map(move |j| {
        let (y, below) = (edge(j, rows, height), edge(j + 1, rows, height));
        (0..columns).map(move |i| {
            let (x, right) = (edge(i, columns, width), edge(i + 1, columns, width));
            Tile { x, y, width: right - x, height: below - y }
        })
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_math::Spectrum;

    #[test]
    fn blocks_tile_the_image() {
        // 3 x 2 pixels 0..6 in 2 x 2 blocks: columns {0}, {1, 2}.
        let pixels: Vec<Spectrum> = (0..6).map(|i| Spectrum::rgb(i as f32, 1.0, 0.0)).collect();
        let image = ImageView::new(3, 2, &pixels).unwrap();
        let means = block_means(&image, 2, 2).unwrap();
        assert_eq!(means, [[0.0, 1.0, 0.0], [1.5, 1.0, 0.0], [3.0, 1.0, 0.0], [4.5, 1.0, 0.0]]);
        assert_eq!(block_means(&image, 1, 1).unwrap(), [[2.5, 1.0, 0.0]]);
        assert_eq!(tiles(&image, 2, 2).unwrap().map(|t| t.width * t.height).sum::<usize>(), 6);
    }
    #[test]
    fn a_block_does_not_hide_a_nan() {
        let pixels = [Spectrum::ONE, Spectrum::rgb(1.0, f32::NAN, 1.0)];
        let means = block_means(&ImageView::new(2, 1, &pixels).unwrap(), 2, 1).unwrap();
        assert!(means[0] == [1.0; 3] && means[1][1].is_nan());
    }
    #[test]
    fn more_blocks_than_pixels_are_refused() {
        let image = ImageView::new(2, 1, &[Spectrum::ONE; 2]).unwrap();
        for (columns, rows) in [(3, 1), (1, 2), (0, 1), (1, 0)] {
            assert!(matches!(block_means(&image, columns, rows), Err(ReportError::Tiling { .. })));
        }
    }
}
