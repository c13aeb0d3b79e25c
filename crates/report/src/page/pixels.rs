//! Pixels as text.

use super::{Embedded, Picture};
use crate::ImageView;
use crate::view::mean;
use base64::Engine;
use half::f16;

/// Longest side of a picture on the page. \[pixel\]
const LONGEST: usize = 960;

/// Pixels a side whose mean is one pixel on the page.
pub(super) fn shrink(width: usize, height: usize) -> usize {
    width.max(height).div_ceil(LONGEST)
}

/// Means over squares of `shrink` x `shrink` pixels, as half floats. What is not finite stays so, to be seen.
pub(super) fn embed(picture: &Picture, shrink: usize) -> Embedded {
    let view: &ImageView = &picture.image;
    let (width, height) = (view.width().div_ceil(shrink), view.height().div_ceil(shrink));
    let mut bytes = Vec::with_capacity(6 * width * height);
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let rows = y * shrink..((y + 1) * shrink).min(view.height());
        let across = || x * shrink..((x + 1) * shrink).min(view.width());
        let square = rows.flat_map(|j| across().map(move |i| j * view.width() + i));
        for c in mean(square.map(|i| view.pixels()[i])) {
            // The largest half is 65504: what is finite stays finite.
            let c = if c.is_finite() { c.clamp(-65504.0, 65504.0) } else { c };
            bytes.extend(f16::from_f64(c).to_le_bytes());
        }
    }
    let data = base64::engine::general_purpose::STANDARD.encode(bytes);
    Embedded { name: picture.name.clone(), caption: picture.caption.clone(), width, height, data }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_math::Spectrum;

    #[test]
    fn squares_become_their_means() {
        let pixels: Vec<Spectrum> = (0..6).map(|i| Spectrum::gray(i as f32)).collect();
        let image = ImageView::new(3, 2, &pixels).unwrap();
        let e = embed(&Picture { name: "a".into(), caption: String::new(), image }, 2);
        let bytes = base64::engine::general_purpose::STANDARD.decode(&e.data).unwrap();
        let halves: Vec<f32> = bytes.chunks(2).map(|b| f16::from_le_bytes([b[0], b[1]]).to_f32()).collect();
        assert_eq!(((e.width, e.height), halves), ((2, 1), vec![2.0, 2.0, 2.0, 3.5, 3.5, 3.5]));
        assert_eq!((shrink(960, 10), shrink(961, 10), shrink(10, 4000)), (1, 2, 5));
    }
}
