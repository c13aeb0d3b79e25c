use super::*;
use ::exr::prelude::f16;
use manylight_sampling::{Purpose, Stream};

fn noise(width: usize, height: usize, seed: u64) -> Image {
    let mut s = Stream::new(seed, [0; 3], Purpose::TEST);
    let pixels = (0..width * height).map(|_| Spectrum::rgb(s.next_f32(), 1e6 * s.next_f32(), -s.next_f32()));
    Image { width, height, pixels: pixels.collect() }
}

fn example() -> Picture {
    let attributes = [
        ("seed", Attribute::Text(u64::MAX.to_string())),
        ("seconds", Attribute::Number(0.1)),
        ("parameters", Attribute::Text("paths=4096 name=\u{2603} \u{e9}".into())),
    ];
    Picture {
        image: noise(37, 21, 1),
        standard_error: Some(noise(37, 21, 2)),
        maps: vec![("cut size".into(), noise(37, 21, 3).pixels.iter().map(|p| p.luminance()).collect())],
        attributes: attributes.map(|(name, value)| (name.to_string(), value)).into(),
    }
}

fn with_channels(size: (usize, usize), channels: Vec<(&str, FlatSamples)>) -> Vec<u8> {
    let channels = channels.into_iter().map(|(name, samples)| AnyChannel::new(text(name), samples)).collect();
    let mut bytes = Cursor::new(Vec::new());
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::UNCOMPRESSED, AnyChannels::sort(channels));
    ExrImage::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn a_picture_comes_back_bit_for_bit_with_its_errors_and_attributes() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    write_exr(&path, &example()).unwrap();
    assert_eq!(read_exr(&path).unwrap(), example());
}
#[test]
fn without_standard_error_there_are_three_channels() {
    let plain = Picture { standard_error: None, maps: vec![], ..example() };
    let back = decode(Cursor::new(encode(&plain).unwrap())).unwrap();
    assert_eq!(back.standard_error, None);
    assert_eq!(back, plain);
}
#[test]
fn samples_that_are_not_finite_are_neither_hidden_nor_refused() {
    let image = Image { width: 2, height: 1, pixels: vec![Spectrum::gray(f32::INFINITY), Spectrum::gray(f32::NAN)] };
    let back = decode(Cursor::new(encode(&image.into()).unwrap())).unwrap().image;
    assert!(back.pixels[0].0.x == f32::INFINITY && back.pixels[1].0.is_nan());
}
#[test]
fn halves_floats_integers_and_further_channels_are_read() {
    let channels = vec![
        ("A", FlatSamples::F32(vec![1.0; 2])),
        ("R", FlatSamples::F16(vec![f16::from_f32(0.5), f16::from_f32(2.0)])),
        ("G", FlatSamples::F32(vec![0.1, 0.2])),
        ("B", FlatSamples::U32(vec![3, 4])),
    ];
    let image = decode(Cursor::new(with_channels((2, 1), channels))).unwrap().image;
    assert_eq!(image.pixels, [Spectrum::rgb(0.5, 0.1, 3.0), Spectrum::rgb(2.0, 0.2, 4.0)]);
}
#[test]
fn luminance_alone_is_gray() {
    let bytes = with_channels((1, 2), vec![("Y", FlatSamples::F32(vec![0.25, 0.5]))]);
    let image = decode(Cursor::new(bytes)).unwrap().image;
    assert_eq!(image, Image { width: 1, height: 2, pixels: vec![Spectrum::gray(0.25), Spectrum::gray(0.5)] });
}
#[test]
fn an_image_without_colours_says_which_channels_it_has() {
    let depth = || FlatSamples::F32(vec![0.0]);
    let channels = vec![("Z", depth()), ("depth.R", depth())];
    let reason = decode(Cursor::new(with_channels((1, 1), channels))).unwrap_err();
    assert!(reason.ends_with("only Z, depth.R"), "{reason}");
    let chroma = vec![("Y", depth()), ("RY", depth()), ("BY", depth())];
    assert!(decode(Cursor::new(with_channels((1, 1), chroma))).is_err());
}
#[test]
fn a_missing_file_and_a_file_of_another_kind_are_named() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    assert!(read_exr(&path).unwrap_err().to_string().starts_with(&format!("cannot read {}", path.display())));
    std::fs::write(&path, "\u{89}PNG, say").unwrap();
    assert!(read_exr(&path).unwrap_err().to_string().contains("a.exr is not a readable OpenEXR image"));
}

// What follows is written by an enemy, or by a disk that is full.

fn data_window_of(bytes: &[u8]) -> usize {
    let name = b"dataWindow\0box2i\0\x10\0\0\0";
    bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len()
}
fn announcing(width: i32, height: i32) -> Vec<u8> {
    let mut bytes = encode(&example()).unwrap();
    let at = data_window_of(&bytes);
    bytes[at + 8..at + 12].copy_from_slice(&(width - 1).to_le_bytes());
    bytes[at + 12..at + 16].copy_from_slice(&(height - 1).to_le_bytes());
    bytes
}
#[test]
fn a_header_that_announces_a_huge_image_is_refused_before_memory_is_asked_for() {
    // A height that contradicts the number of chunks is found out by the library, a width is not.
    let reason = decode(Cursor::new(announcing(1_000_000_000, 21))).unwrap_err();
    assert!(reason.contains("147000000000 samples") && reason.contains("limit"), "{reason}");
    for (width, height) in [(30_000, 30_000), (i32::MAX, 21), (37, i32::MAX), (1 << 30, 1 << 30), (1_000_000, 21)] {
        assert!(decode(Cursor::new(announcing(width, height))).is_err(), "{width} x {height}");
    }
}
#[test]
fn the_limit_counts_all_parts_and_channels() {
    let chunks = block::read(Cursor::new(encode(&example()).unwrap()), false).unwrap();
    let mut headers = chunks.headers().to_vec();
    headers[0].layer_size = ::exr::math::Vec2(1 << 14, 1 << 11); // 2^25 pixels, 7 channels
    assert!(check(&headers).is_ok());
    headers.push(headers[0].clone());
    let reason = check(&headers).unwrap_err();
    assert!(reason.contains(&(14u64 << 25).to_string()) && reason.contains("limit"), "{reason}");
}
#[test]
fn a_truncated_file_is_an_error_wherever_it_ends() {
    let bytes = encode(&example()).unwrap();
    for end in (0..bytes.len()).step_by(7).chain(bytes.len() - 8..bytes.len()) {
        assert!(decode(Cursor::new(&bytes[..end])).is_err(), "{end} of {} bytes were enough", bytes.len());
    }
}
#[test]
fn a_damaged_file_gives_an_error_or_an_image_but_never_a_panic() {
    let plain = encode(&example()).unwrap();
    let halves = |n: usize| FlatSamples::F16((0..n).map(|i| f16::from_f32(i as f32)).collect());
    let other = with_channels((16, 16), vec![("R", halves(256)), ("G", halves(256)), ("B", halves(256))]);
    for (i, original) in [plain, other].iter().enumerate() {
        let header = data_window_of(original) + 200;
        let mut s = Stream::new(3, [i as u64, 0, 0], Purpose::TEST);
        let mut refused = 0;
        for _ in 0..1500 {
            let mut bytes = original.clone();
            for _ in 0..1 + s.next_below(6) {
                // Most of what can be said wrongly is said in the header.
                let below = if s.next_below(3) == 0 { bytes.len() } else { header.min(bytes.len()) };
                bytes[s.next_below(below)] = s.next_u64() as u8;
            }
            refused += usize::from(decode(Cursor::new(bytes)).is_err());
        }
        assert!(refused > 300, "only {refused} of 1500 were refused");
    }
}
