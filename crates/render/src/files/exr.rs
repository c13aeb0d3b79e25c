//! OpenEXR: the image itself, with its standard error and how it came about.

use super::write_atomically;
use crate::RenderError;
use ::exr::block;
use ::exr::image::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image as ExrImage, Layer,
    read::{image::ReadLayers, layers::ReadChannels, read},
    write::WritableImage,
};
use ::exr::meta::attribute::{AttributeValue, Text};
use ::exr::meta::header::{Header, LayerAttributes};
use manylight_framework::Image;
use manylight_math::Spectrum;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek};
use std::path::Path;

/// The most samples (pixels times channels, over all parts) a file may announce: 8192 x 8192 pixels of four channels, 1 GiB
/// as floats. A file that announces more is refused before anything is allocated.
pub const MAX_SAMPLES: u64 = 1 << 28;

/// An image, what is known of its noise, and what is known of its origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Channels R, G, B.
    pub image: Image,
    /// Standard error of the mean over passes: channels stderr.R, stderr.G, stderr.B. Absent where there was one pass.
    pub standard_error: Option<Image>,
    /// Other values of each pixel, each a channel of its name: `cut size`, say.
    pub maps: Vec<(String, Vec<f32>)>,
    /// Header attributes by name.
    pub attributes: BTreeMap<String, Attribute>,
}

/// The value of a header attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    /// Text (UTF-8). Whole numbers above 2^53, as seeds may be, belong here.
    Text(String),
    /// A number.
    Number(f64),
}

impl From<Image> for Picture {
    fn from(image: Image) -> Self {
        Picture { image, standard_error: None, maps: Vec::new(), attributes: BTreeMap::new() }
    }
}

/// Writes a picture as 32-bit floats, losslessly compressed (ZIP, which every reader knows).
pub fn write_exr(path: &Path, picture: &Picture) -> Result<(), RenderError> {
    let bytes = encode(picture).map_err(|e| RenderError::write(path, std::io::Error::other(e)))?;
    write_atomically(path, &bytes)
}

/// Reads the first part of a file that has channels R, G, B, or Y alone (then gray), of any sample type. The image is the
/// data window. Deep data and subsampled channels are refused, and so is what announces more than [`MAX_SAMPLES`].
/// Attributes that are neither text nor a number are left out. Samples that are not finite are handed on as they are.
pub fn read_exr(path: &Path) -> Result<Picture, RenderError> {
    let file = File::open(path).map_err(|e| RenderError::read(path, e))?;
    decode(BufReader::new(file)).map_err(|reason| RenderError::not_an_image(path, reason))
}

const STANDARD_ERROR: &str = "stderr.";

fn encode(picture: &Picture) -> ::exr::error::Result<Vec<u8>> {
    let mut channels = channels_of("", &picture.image);
    if let Some(error) = &picture.standard_error {
        channels.extend(channels_of(STANDARD_ERROR, error));
    }
    for (name, values) in &picture.maps {
        channels.push(AnyChannel::new(text(name), FlatSamples::F32(values.clone())));
    }
    let mut attributes = LayerAttributes::default();
    attributes.other.extend(picture.attributes.iter().map(|(name, value)| (text(name), value.into())));
    let size = (picture.image.width, picture.image.height);
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels.into()));
    let mut bytes = Cursor::new(Vec::new());
    ExrImage::from_layer(layer).write().non_parallel().to_buffered(&mut bytes)?;
    Ok(bytes.into_inner())
}

fn channels_of(prefix: &str, image: &Image) -> Vec<AnyChannel<FlatSamples>> {
    let channel = |(i, name)| {
        let samples = image.pixels.iter().map(|p| p.to_array()[i]).collect();
        AnyChannel::new(text(&format!("{prefix}{name}")), FlatSamples::F32(samples))
    };
    ["R", "G", "B"].into_iter().enumerate().map(channel).collect()
}

fn decode(file: impl Read + Seek) -> Result<Picture, String> {
    let chunks = block::read(file, false).map_err(|e| e.to_string())?;
    check(chunks.headers())?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_chunks(chunks)
        .map_err(|e| e.to_string())?;
    for layer in &image.layer_data {
        let Some(pixels) = colours(layer, "").or_else(|| luminance(layer)) else { continue };
        let others = image.attributes.other.iter().chain(&layer.attributes.other);
        return Ok(Picture {
            image: pixels,
            standard_error: colours(layer, STANDARD_ERROR),
            maps: maps(layer),
            attributes: others.filter_map(|(name, value)| Some((string(name), known(value)?))).collect(),
        });
    }
    let names: Vec<String> =
        image.layer_data.iter().flat_map(|layer| &layer.channel_data.list).map(|c| string(&c.name)).collect();
    Err(format!("no part of it has channels R, G and B, or Y alone, but only {}", names.join(", ")))
}

/// Everything that decides how much memory the decoder will ask for.
fn check(headers: &[Header]) -> Result<(), String> {
    let mut samples = 0u64;
    for header in headers {
        if header.deep {
            return Err("deep images are not supported".into());
        }
        if header.channels.list.iter().any(|c| c.sampling.0 != 1 || c.sampling.1 != 1) {
            return Err("subsampled channels are not supported".into());
        }
        let factors = [header.layer_size.width(), header.layer_size.height(), header.channels.list.len()];
        let part = factors.iter().fold(1u64, |product, &n| product.saturating_mul(n as u64));
        samples = samples.saturating_add(part);
    }
    if samples > MAX_SAMPLES {
        return Err(format!("it announces {samples} samples, more than the limit of {MAX_SAMPLES}"));
    }
    Ok(())
}

type AnyLayer = Layer<AnyChannels<FlatSamples>>;

fn channel(layer: &AnyLayer, name: &str) -> Option<Vec<f32>> {
    let channel = layer.channel_data.list.iter().find(|c| c.name.eq(name))?;
    Some(channel.sample_data.values_as_f32().collect())
}

fn colours(layer: &AnyLayer, prefix: &str) -> Option<Image> {
    let [r, g, b] = ["R", "G", "B"].map(|name| channel(layer, &format!("{prefix}{name}")));
    let (r, g, b) = (r?, g?, b?);
    let pixels = r.iter().zip(&g).zip(&b).map(|((&r, &g), &b)| Spectrum::rgb(r, g, b)).collect();
    Some(image(layer, pixels))
}

/// All channels that are no part of a colour.
fn maps(layer: &AnyLayer) -> Vec<(String, Vec<f32>)> {
    let named = layer.channel_data.list.iter().map(|c| (string(&c.name), c));
    let colour = |name: &str| ["R", "G", "B", "A", "Y"].contains(&name.rsplit('.').next().unwrap_or(name));
    named.filter(|(name, _)| !colour(name)).map(|(name, c)| (name, c.sample_data.values_as_f32().collect())).collect()
}

fn luminance(layer: &AnyLayer) -> Option<Image> {
    let chroma = ["RY", "BY"].iter().any(|name| layer.channel_data.list.iter().any(|c| c.name.eq(name)));
    let y = channel(layer, "Y").filter(|_| !chroma)?;
    Some(image(layer, y.into_iter().map(Spectrum::gray).collect()))
}

fn image(layer: &AnyLayer, pixels: Vec<Spectrum>) -> Image {
    Image { width: layer.size.width(), height: layer.size.height(), pixels }
}

/// The library's own conversion turns UTF-8 into Latin-1 and panics where that cannot be.
fn text(s: &str) -> Text {
    Text::from_slice_unchecked(s.as_bytes())
}

fn string(text: &Text) -> String {
    String::from_utf8_lossy(text.as_slice()).into_owned()
}

impl From<&Attribute> for AttributeValue {
    fn from(attribute: &Attribute) -> Self {
        match attribute {
            Attribute::Text(s) => AttributeValue::Text(text(s)),
            Attribute::Number(x) => AttributeValue::F64(*x),
        }
    }
}

fn known(value: &AttributeValue) -> Option<Attribute> {
    match value {
        AttributeValue::Text(s) => Some(Attribute::Text(string(s))),
        AttributeValue::F64(x) => Some(Attribute::Number(*x)),
        AttributeValue::F32(x) => Some(Attribute::Number((*x).into())),
        AttributeValue::I32(x) => Some(Attribute::Number((*x).into())),
        _ => None,
    }
}

#[cfg(test)]
#[path = "exr_tests.rs"]
mod tests;
