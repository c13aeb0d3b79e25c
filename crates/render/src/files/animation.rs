//! Animated PNG: browsers play it, what knows nothing of animation shows its first frame.

use super::png::{size, srgb_bytes};
use super::write_atomically;
use crate::RenderError;
use ::png::{BitDepth, ColorType, Encoder, EncodingError};
use manylight_framework::Image;
use std::io;
use std::path::Path;

/// Frames a second. [1/s]
pub const FRAME_RATE: u16 = 24;

/// Frames of one size, with 8 bits a channel, to be played again and again.
#[derive(Default)]
pub struct Animation {
    size: (usize, usize),
    frames: Vec<Vec<u8>>,
}

impl Animation {
    /// Adds a frame at an exposure value. All have to be as large as the first.
    pub fn add(&mut self, image: &Image, ev: f32) {
        let size = (image.width, image.height);
        assert!(self.frames.is_empty() || self.size == size, "frames of {size:?} and {:?} pixels", self.size);
        self.size = size;
        self.frames.push(srgb_bytes(image, ev));
    }
    /// Frames there are.
    pub fn frames(&self) -> usize {
        self.frames.len()
    }
    /// Writes the file; an error if there is no frame.
    pub fn write(&self, path: &Path) -> Result<(), RenderError> {
        let (width, height) = size(path, self.size)?;
        let mut file = Vec::new();
        self.encode(&mut file, width, height).map_err(|e| RenderError::write(path, io::Error::other(e)))?;
        write_atomically(path, &file)
    }
    fn encode(&self, file: &mut Vec<u8>, width: u32, height: u32) -> Result<(), EncodingError> {
        let mut encoder = Encoder::new(file, width, height);
        encoder.set_color(ColorType::Rgb);
        encoder.set_depth(BitDepth::Eight);
        // 0: without end.
        encoder.set_animated(self.frames.len() as u32, 0)?;
        encoder.set_frame_delay(1, FRAME_RATE)?;
        let mut writer = encoder.write_header()?;
        self.frames.iter().try_for_each(|frame| writer.write_image_data(frame))?;
        writer.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use manylight_math::Spectrum;

    fn gray(x: f32) -> Image {
        Image { width: 2, height: 1, pixels: vec![Spectrum::gray(x); 2] }
    }
    #[test]
    fn frames_come_back_in_their_order_and_at_one_exposure() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        let mut animation = Animation::default();
        [0.0, 0.107_93, 0.5].iter().for_each(|x| animation.add(&gray(*x), 1.0));
        animation.write(&path).unwrap();
        let mut reader =
            ::png::Decoder::new(io::BufReader::new(std::fs::File::open(&path).unwrap())).read_info().unwrap();
        assert_eq!(reader.info().animation_control.map(|a| (a.num_frames, a.num_plays)), Some((3, 0)));
        for expected in [0, 128, 255] {
            let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut bytes).unwrap();
            assert_eq!(bytes, [expected; 6]);
        }
    }
    #[test]
    fn nothing_is_no_animation() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.png");
        assert!(Animation::default().write(&path).is_err());
        assert!(!path.exists());
    }
}
