//! Images from files: PNG, JPEG, Radiance HDR and OpenEXR, as linear RGB.

use exr::prelude as exr;
use image::{DynamicImage, ImageDecoder, ImageReader, Limits};
use manylight_math::Spectrum;
use manylight_scene::Bitmap;
use rayon::prelude::*;
use std::io::Cursor;

/// No image may be wider or higher. [pixel]
const MOST_PIXELS_ACROSS: usize = 1 << 17;
/// No image may have more pixels. 1.6 GB as linear RGB.
const MOST_PIXELS: usize = 1 << 27;

/// The electro-optical transfer function of sRGB.
pub(crate) fn srgb_to_linear(x: f32) -> f32 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// Reads a file's content, and the least and largest value of any channel. 8- and 16-bit images are sRGB and are linearised, unless
/// `raw`; alpha is passed over.
pub(crate) fn read(bytes: &[u8], raw: bool) -> Result<(Bitmap, [f32; 2]), String> {
    let bitmap = if bytes.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
        read_exr(bytes)?
    } else {
        match read_other(bytes, raw)? {
            // Of whole numbers: they need not be looked through, which for large images takes as long as to write them.
            (bitmap, true) => return Ok((bitmap, [0.0, 1.0])),
            (bitmap, false) => bitmap,
        }
    };
    let mut extent = [f32::INFINITY, f32::NEG_INFINITY];
    for (i, p) in bitmap.pixels.iter().enumerate() {
        if !p.is_finite() {
            return Err(format!("pixel ({}, {}) is not finite", i % bitmap.width, i / bitmap.width));
        }
        extent = [extent[0].min(p.0.min_element()), extent[1].max(p.largest())];
    }
    Ok((bitmap, extent))
}

/// Headers lie: what they promise is bounded by limits, and by what so many bytes could hold if compressed 10,000 to one.
fn check_size(width: usize, height: usize, bytes: usize) -> Result<(), String> {
    if width == 0 || height == 0 {
        return Err("the image has no pixels".into());
    }
    let pixels = width.saturating_mul(height);
    if width.max(height) > MOST_PIXELS_ACROSS || pixels > MOST_PIXELS {
        return Err(format!("the image is too large ({width} x {height}; at most {MOST_PIXELS} pixels are read)"));
    }
    if pixels > bytes.saturating_mul(10_000) {
        return Err(format!("{bytes} bytes cannot hold the {width} x {height} pixels that the header promises"));
    }
    Ok(())
}

/// Also whether it is of whole numbers.
fn read_other(bytes: &[u8], raw: bool) -> Result<(Bitmap, bool), String> {
    let broken = |e: image::ImageError| format!("cannot be decoded: {e}");
    // Some writers of Radiance files, Mitsuba's among them, name the program otherwise than the decoder expects.
    let renamed;
    let bytes = match bytes.strip_prefix(b"#?RGBE\n") {
        Some(rest) => {
            renamed = [b"#?RADIANCE\n".as_slice(), rest].concat();
            renamed.as_slice()
        }
        None => bytes,
    };
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    if reader.format().is_none_or(|f| !f.reading_enabled()) {
        return Err("not an image of a supported format: PNG, JPEG, Radiance HDR (.hdr) or OpenEXR".into());
    }
    let mut limits = Limits::default();
    limits.max_image_width = Some(MOST_PIXELS_ACROSS as u32);
    limits.max_image_height = Some(MOST_PIXELS_ACROSS as u32);
    limits.max_alloc = Some(4 << 30);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    check_size(width, height, bytes.len())?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(broken)?;
    let whole = !matches!(decoded, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    Ok((Bitmap { width, height, pixels: linear_pixels(decoded, raw) }, whole))
}

fn linear_pixels(image: DynamicImage, raw: bool) -> Vec<Spectrum> {
    let curve = |x: f32| if raw { x } else { srgb_to_linear(x) };
    match image {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            image.into_rgb32f().pixels().map(|p| Spectrum::from(p.0)).collect()
        }
        DynamicImage::ImageLuma16(_)
        | DynamicImage::ImageLumaA16(_)
        | DynamicImage::ImageRgb16(_)
        | DynamicImage::ImageRgba16(_) => {
            let table: Vec<f32> = (0..=u16::MAX).map(|i| curve(f32::from(i) / 65535.0)).collect();
            let pixels = image.into_rgb16().into_raw();
            pixels.par_chunks_exact(3).map(|p| Spectrum::from([p[0], p[1], p[2]].map(|c| table[c as usize]))).collect()
        }
        _ => {
            let table: Vec<f32> = (0..=u8::MAX).map(|i| curve(f32::from(i) / 255.0)).collect();
            let pixels = image.into_rgb8().into_raw();
            pixels.par_chunks_exact(3).map(|p| Spectrum::from([p[0], p[1], p[2]].map(|c| table[c as usize]))).collect()
        }
    }
}

/// The first layer with R, G, B, or with a single channel Y.
fn read_exr(bytes: &[u8]) -> Result<Bitmap, String> {
    use self::exr::{ReadChannels, ReadLayers};
    let broken = |e: exr::Error| format!("cannot be decoded: {e}");
    // The decoder allocates what a header promises: look at it first.
    let meta = ::exr::meta::MetaData::read_from_buffered(Cursor::new(bytes), true).map_err(broken)?;
    for header in &meta.headers {
        check_size(header.layer_size.width(), header.layer_size.height(), bytes.len())?;
        if header.channels.list.len() > 64 || header.deep {
            return Err("deep images and images of more than 64 channels are not supported".into());
        }
    }
    let image = exr::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(broken)?;
    for layer in &image.layer_data {
        let find = |name: &str| layer.channel_data.list.iter().find(|c| c.name.eq_case_insensitive(name));
        let channels = match (find("R"), find("G"), find("B"), find("Y")) {
            (Some(r), Some(g), Some(b), _) => [r, g, b],
            (_, _, _, Some(y)) => [y, y, y],
            _ => continue,
        };
        if channels.iter().any(|c| c.sampling != exr::Vec2(1, 1)) {
            return Err("subsampled channels are not supported".into());
        }
        let (width, height) = (layer.size.width(), layer.size.height());
        let [r, g, b] = channels.map(|c| c.sample_data.values_as_f32().collect::<Vec<f32>>());
        let pixels = r.iter().zip(&g).zip(&b).map(|((&r, &g), &b)| Spectrum::rgb(r, g, b)).collect();
        return Ok(Bitmap { width, height, pixels });
    }
    Err("no layer has the channels R, G, B or Y".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn png(image: DynamicImage) -> Vec<u8> {
        let mut bytes = Vec::new();
        image.write_to(&mut Cursor::new(&mut bytes), image::ImageFormat::Png).unwrap();
        bytes
    }

    #[test]
    fn eight_and_sixteen_bit_images_are_linearised_unless_raw() {
        // mitsuba 3.9.1: a pixel of value 128 evaluates to 0.2159.
        let small = png(DynamicImage::ImageLuma8(image::GrayImage::from_pixel(2, 1, image::Luma([128]))));
        let deep = png(DynamicImage::ImageRgb16(image::ImageBuffer::from_pixel(2, 1, image::Rgb([128 * 257; 3]))));
        for bytes in [small, deep] {
            let (bitmap, extent) = read(&bytes, false).unwrap();
            assert_eq!((bitmap.width, bitmap.height, extent), (2, 1, [0.0, 1.0]));
            assert!((bitmap.pixels[1].0.x - 0.2159).abs() < 1e-4, "{:?}", bitmap.pixels[1]);
            assert!((read(&bytes, true).unwrap().0.pixels[1].0.x - 128.0 / 255.0).abs() < 1e-6);
        }
    }
    #[test]
    fn a_radiance_file_is_read_whoever_says_he_wrote_it() {
        let pixels = [image::Rgb([2.0f32, 1.0, 0.5]); 4];
        let mut bytes = Vec::new();
        image::codecs::hdr::HdrEncoder::new(&mut bytes).encode(&pixels, 2, 2).unwrap();
        let other = [b"#?RGBE\n".as_slice(), bytes.strip_prefix(b"#?RADIANCE\n").unwrap()].concat();
        for bytes in [bytes, other] {
            let (bitmap, extent) = read(&bytes, false).unwrap();
            assert_eq!((bitmap.pixels[3], extent), (Spectrum::rgb(2.0, 1.0, 0.5), [0.5, 2.0]));
        }
    }
    #[test]
    fn an_exr_comes_back_as_it_was_written() {
        let mut bytes = Cursor::new(Vec::new());
        let pixel = |p: exr::Vec2<usize>| (p.x() as f32, p.y() as f32, 1e6f32);
        let image = exr::Image::from_channels((3, 2), exr::SpecificChannels::rgb(pixel));
        exr::WritableImage::write(&image).to_buffered(&mut bytes).unwrap();
        let (bitmap, extent) = read(bytes.get_ref(), false).unwrap();
        assert_eq!(extent, [0.0, 1e6]);
        assert_eq!((bitmap.width, bitmap.height), (3, 2));
        assert_eq!(bitmap.pixels[5], Spectrum::rgb(2.0, 1.0, 1e6));
        let cut = &bytes.get_ref()[..bytes.get_ref().len() - 9];
        assert!(read(cut, false).unwrap_err().contains("cannot be decoded"));
    }
    #[test]
    fn a_header_that_promises_too_much_is_refused_before_memory_is_asked_for() {
        let mut bytes = png(DynamicImage::ImageLuma8(image::GrayImage::new(4, 4)));
        bytes[16..24].copy_from_slice(&[0, 0, 0x80, 0, 0, 0, 0x80, 0]); // 32768 x 32768
        // The checksum is that of the lie.
        let mut crc = u32::MAX;
        for byte in &bytes[12..29] {
            crc ^= u32::from(*byte);
            (0..8).for_each(|_| crc = if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 });
        }
        bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
        let message = read(&bytes, false).unwrap_err();
        assert!(message.contains("32768 x 32768"), "{message}");
        assert!(read(b"BM not one of ours", false).unwrap_err().contains("PNG, JPEG"));
    }
}
