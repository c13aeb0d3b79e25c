//! What the arguments of `compare` mean.

use crate::args::duration;
use manylight_report::Cost;
use std::path::PathBuf;

/// A method with parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// As it was written: what it is called everywhere.
    pub label: String,
    /// The method.
    pub method: String,
    /// Its parameters.
    pub parameters: Vec<(String, String)>,
}

/// `a,b:x=1,y=2,c`: methods, each with its parameters behind a colon. What holds `=` belongs to the method before.
pub fn methods(text: &str) -> Result<Methods, String> {
    let mut found: Vec<Spec> = Vec::new();
    for word in text.split(',').map(str::trim) {
        let (name, parameter) = match (word.split_once(':'), word.contains('=')) {
            (Some((name, parameter)), _) if !name.contains('=') => (Some(name), Some(parameter)),
            (_, true) => (None, Some(word)),
            _ => (Some(word), None),
        };
        if let Some(name) = name {
            if name.is_empty() {
                return Err("expected NAME or NAME:key=value,.. between commas".into());
            }
            found.push(Spec { label: word.into(), method: name.into(), parameters: Vec::new() });
        }
        let Some(parameter) = parameter else { continue };
        let last = found.last_mut().ok_or_else(|| format!("`{word}` belongs to no method: expected NAME:{word}"))?;
        let (key, value) = parameter.split_once('=').ok_or_else(|| format!("`{word}`: expected NAME:key=value"))?;
        if name.is_none() {
            last.label = format!("{},{word}", last.label);
        }
        last.parameters.push((key.into(), value.into()));
    }
    Ok(Methods(found))
}

/// The methods of one `--methods`.
#[derive(Clone, Debug, PartialEq)]
pub struct Methods(pub Vec<Spec>);

/// One budget of `--times`.
pub fn time(text: &str) -> Result<Cost, String> {
    duration(text).map(|d| Cost::Seconds(d.as_secs_f64()))
}

/// One budget of `--passes`.
pub fn passes(text: &str) -> Result<Cost, String> {
    match text.parse() {
        Ok(n) if n > 0 => Ok(Cost::Passes(n)),
        _ => Err("expected a whole number above zero".into()),
    }
}

/// `NAME=FILE.exr@SECONDS`: an image from elsewhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Foreign {
    /// What it is called.
    pub name: String,
    /// Where it is.
    pub path: PathBuf,
    /// What it took. \[s\]
    pub seconds: f64,
}

/// Reads `NAME=FILE.exr@SECONDS`; the seconds are a number, or have a unit as elsewhere.
pub fn foreign(text: &str) -> Result<Foreign, String> {
    let expected = || "expected NAME=FILE.exr@SECONDS, such as mitsuba=image.exr@12.5".to_string();
    let (name, rest) = text.split_once('=').ok_or_else(expected)?;
    let (path, time) = rest.rsplit_once('@').ok_or_else(expected)?;
    let seconds = match time.parse::<f64>() {
        Ok(s) => s,
        Err(_) => duration(time)?.as_secs_f64(),
    };
    if name.is_empty() || path.is_empty() || !(seconds > 0.0 && seconds.is_finite()) {
        return Err(expected());
    }
    Ok(Foreign { name: name.into(), path: path.into(), seconds })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<(String, String, String)> {
        let joined = |s: &Spec| s.parameters.iter().map(|(k, v)| format!("{k}={v}")).collect::<Vec<_>>().join(" ");
        let all = methods(text).unwrap().0;
        all.iter().map(|s| (s.label.clone(), s.method.clone(), joined(s))).collect()
    }
    #[test]
    fn commas_part_methods_and_their_parameters() {
        let own = |l: &str, m: &str, p: &str| (l.to_string(), m.to_string(), p.to_string());
        assert_eq!(
            read("path,vsl:paths=64,bound=none,light-bvh"),
            [
                own("path", "path", ""),
                own("vsl:paths=64,bound=none", "vsl", "paths=64 bound=none"),
                own("light-bvh", "light-bvh", "")
            ]
        );
        assert!(methods("paths=3").unwrap_err().contains("belongs to no method"));
        assert!(methods("a,,b").is_err() && methods("a:b").is_err() && methods("").is_err());
    }
    #[test]
    fn images_from_elsewhere_have_a_name_and_a_time() {
        let read = foreign("mitsuba=a@b.exr@2.5").unwrap();
        assert_eq!((read.name.as_str(), read.path, read.seconds), ("mitsuba", PathBuf::from("a@b.exr"), 2.5));
        assert_eq!(foreign("m=a.exr@2m").unwrap().seconds, 120.0);
        for wrong in ["a.exr", "m=a.exr", "m=a.exr@", "m=a.exr@-1", "=a.exr@1", "m=@1", "m=a.exr@nan"] {
            assert!(foreign(wrong).is_err(), "{wrong}");
        }
    }
    #[test]
    fn budgets_are_above_zero() {
        assert_eq!((time("250ms"), passes("16")), (Ok(Cost::Seconds(0.25)), Ok(Cost::Passes(16))));
        assert!(passes("0").is_err() && time("3").is_err());
    }
}
