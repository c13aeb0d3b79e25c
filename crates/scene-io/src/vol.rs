//! Mitsuba's grids (`.vol`): "VOL", version 3, type 1 (f32), the sizes, the channels, a box, and the values, x fastest.

use manylight_math::{DAffine3, DMat3, DVec3, Spectrum};

/// A grid as it is in its file.
#[derive(Debug)]
pub(crate) struct RawGrid {
    pub(crate) size: [usize; 3],
    pub(crate) values: Vec<Spectrum>,
    /// From the unit cube to the file's box.
    pub(crate) to_box: DAffine3,
}

/// Reads a file's bytes.
pub(crate) fn read(bytes: &[u8]) -> Result<RawGrid, String> {
    if bytes.get(..3) != Some(b"VOL") {
        return Err("it does not begin with `VOL`".into());
    }
    if bytes.len() < 48 {
        return Err("it ends within its header".into());
    }
    if bytes[3] != 3 {
        return Err(format!("it is of version {}: expected 3", bytes[3]));
    }
    let word = |at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
    let integer = |at: usize| i32::from_le_bytes(word(at));
    let float = |at: usize| f32::from_le_bytes(word(at));
    if integer(4) != 1 {
        return Err(format!("its values are of type {}: expected 1 (32-bit floats)", integer(4)));
    }
    let (mut size, channels) = ([0usize; 3], integer(20));
    for (axis, n) in size.iter_mut().enumerate() {
        *n = usize::try_from(integer(8 + 4 * axis)).ok().filter(|n| *n > 0).ok_or("its size is not positive")?;
    }
    if channels != 1 && channels != 3 {
        return Err(format!("it has {channels} channels: expected 1 or 3"));
    }
    let channels = channels as usize;
    let count = size.iter().try_fold(1usize, |n, s| n.checked_mul(*s));
    let expected = count.and_then(|n| n.checked_mul(4 * channels)).and_then(|n| n.checked_add(48));
    if expected != Some(bytes.len()) {
        let [x, y, z] = size;
        return Err(format!("its {} bytes are not those of {x} x {y} x {z} x {channels} values", bytes.len()));
    }
    let corner = |at: usize| DVec3::new(float(at).into(), float(at + 4).into(), float(at + 8).into());
    let (lo, hi) = (corner(24), corner(36));
    let value = |i: usize| float(48 + 4 * i);
    let values: Vec<Spectrum> = (0..count.unwrap_or(0))
        .map(|i| match channels {
            1 => Spectrum::gray(value(i)),
            _ => Spectrum::rgb(value(3 * i), value(3 * i + 1), value(3 * i + 2)),
        })
        .collect();
    if let Some(bad) = values.iter().position(|v| !v.is_valid()) {
        return Err(format!("value {bad} is {:?}: expected finite numbers, not negative", values[bad].0));
    }
    Ok(RawGrid { size, values, to_box: DAffine3 { matrix3: DMat3::from_diagonal(hi - lo), translation: lo } })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(size: [i32; 3], channels: i32, values: &[f32]) -> Vec<u8> {
        let mut bytes = b"VOL\x03".to_vec();
        bytes.extend([1, size[0], size[1], size[2], channels].iter().flat_map(|i: &i32| i.to_le_bytes()));
        bytes.extend([-1.0f32, 0.0, 0.0, 1.0, 1.0, 4.0].iter().chain(values).flat_map(|x| x.to_le_bytes()));
        bytes
    }
    #[test]
    fn values_and_box_are_read() {
        let g = read(&file([2, 1, 1], 3, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])).unwrap();
        assert_eq!((g.size, g.values[1]), ([2, 1, 1], Spectrum::rgb(4.0, 5.0, 6.0)));
        assert_eq!(g.to_box.transform_point3(DVec3::ONE), DVec3::new(1.0, 1.0, 4.0));
        assert_eq!(read(&file([1, 2, 1], 1, &[1.0, 2.0])).unwrap().values[1], Spectrum::gray(2.0));
    }
    #[test]
    fn what_is_no_grid_is_refused_without_allocating() {
        let good = file([2, 1, 1], 1, &[1.0, 2.0]);
        for cut in 0..good.len() {
            assert!(read(&good[..cut]).is_err(), "{cut}");
        }
        assert!(read(&file([i32::MAX; 3], 1, &[1.0])).unwrap_err().contains("are not those of"));
        assert!(read(&file([-1, 1, 1], 1, &[1.0])).unwrap_err().contains("not positive"));
        assert!(read(&file([1; 3], 2, &[1.0, 1.0])).unwrap_err().contains("2 channels"));
        assert!(read(&file([1; 3], 1, &[f32::NAN])).unwrap_err().contains("value 0"));
        assert!(read(&file([1; 3], 1, &[-1.0])).is_err());
    }
}
