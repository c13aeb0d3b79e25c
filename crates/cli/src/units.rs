//! Numbers as people read them.

use std::time::Duration;

/// `8.3 s`, `4 min 05 s`, `1 h 30 min`.
pub fn time(time: Duration) -> String {
    let seconds = time.as_secs_f64();
    // The limits lie where rounding would show 60.0 s or 60 min.
    if seconds < 59.95 {
        return format!("{seconds:.1} s");
    }
    let whole = seconds.round() as u64;
    if whole < 3600 {
        return format!("{} min {:02} s", whole / 60, whole % 60);
    }
    let minutes = (seconds / 60.0).round() as u64;
    format!("{} h {:02} min", minutes / 60, minutes % 60)
}

/// Three digits and a unit of a thousand: `999`, `1.23 k`, `45.6 M`.
pub fn count(n: f64) -> String {
    let mut scaled = n;
    for unit in ["", " k", " M", " G"] {
        // The limit is where three digits round up to 1000.
        if scaled < 999.5 {
            return format!("{}{unit}", three_digits(scaled));
        }
        scaled /= 1000.0;
    }
    format!("{} T", three_digits(scaled))
}

fn three_digits(x: f64) -> String {
    let decimals = if x >= 99.95 || x == x.round() {
        0
    } else if x >= 9.995 {
        1
    } else {
        2
    };
    format!("{x:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_rounded_to_what_matters() {
        let seconds = |s| time(Duration::from_secs_f64(s));
        assert_eq!(seconds(8.34), "8.3 s");
        assert_eq!(seconds(59.97), "1 min 00 s");
        assert_eq!(seconds(245.0), "4 min 05 s");
        assert_eq!(seconds(3599.9), "1 h 00 min");
        assert_eq!(seconds(5400.0), "1 h 30 min");
    }
    #[test]
    fn counts_have_three_digits() {
        let numbers = [0.0, 7.0, 999.0, 999.7, 1234.0, 45_600_000.0, 99_960.0, 2e15];
        let expected = ["0", "7", "999", "1.00 k", "1.23 k", "45.6 M", "100 k", "2000 T"];
        assert_eq!(numbers.map(count), expected);
    }
}
